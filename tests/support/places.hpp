#pragma once

#include <filesystem>

namespace paracal::test {

/// The folder of the sources and that of this build. They stand in one small file, so that all others compile to the
/// same in every folder.
std::filesystem::path source_folder();
std::filesystem::path build_folder();

}  // namespace paracal::test
