# Gathers the licences of the libraries that the program is made of, as their Debian packages state them:
#   cmake -DOUTPUT= -P notices.cmake
# Name | Debian package | SPDX expression of what of it is used (tools/sbom.mjs).
set(packages
  "Eigen|libeigen3-dev|MPL-2.0"
  "Random123|librandom123-dev|BSD-3-Clause"
  "oneTBB|libtbb-dev|Apache-2.0"
  "NLopt|libnlopt-dev|MIT AND LGPL-2.1-or-later AND BSD-3-Clause"
  "{fmt}|libfmt-dev|MIT"
  "toml++|libtomlplusplus-dev|MIT"
  "libcsv|libcsv-dev|LGPL-2.1-or-later"
  "nlohmann-json|nlohmann-json3-dev|MIT"
  "CLI11|libcli11-dev|BSD-3-Clause"
  "libmd|libmd-dev|BSD-3-Clause AND BSD-2-Clause AND ISC"
  "zlib|zlib1g-dev|Zlib")
set(text "Boost.Locale\nBoost.Math\n\nBoost Software License 1.0, which asks for no notice in programs.\n\n")
string(REPEAT "-" 60 line)
string(APPEND text "${line}\n\n")
foreach(entry IN LISTS packages)
  string(REPLACE "|" ";" entry "${entry}")
  list(GET entry 0 name)
  list(GET entry 1 package)
  set(file /usr/share/doc/${package}/copyright)
  if(EXISTS ${file})
    file(READ ${file} licence)
  else()
    message(WARNING "${name}: expected its licence in ${file}, got none: paracal --licenses cannot show it")
    set(licence "Its licence was not there when this program was built: see the project ${name}.\n")
  endif()
  string(APPEND text "${name}\n\n${licence}\n${line}\n\n")
endforeach()
file(WRITE ${OUTPUT} "${text}")
