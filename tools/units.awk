# Writes for each translation unit what its compilation reads of this repository into a file of FOLDER, named as the unit with + for /: the environment,
# its command, and blob and path of every file that it includes, and those include, whatever conditions stand around. In:
#   "E HASH" the environment; "B HASH PATH" a file; "I PATH:#include "NAME" a line of it; "C ..." a line of compile_commands.json; "U UNIT" a unit
function folder(file) { sub(/[^\/]*$/, "", file); return file }
function reach(file,    k, n, names, root) {
  if (file in seen || !(file in blob)) return
  seen[file] = 1
  list = list blob[file] " " file "\n"
  n = split(included[file], names, "\n")
  for (k = 1; k < n; ++k) {
    reach(folder(file) names[k])
    for (root = 1; root <= root_count; ++root) reach(roots[root] "/" names[k])
  }
}
/^E / { environment = $2 }
/^B / { blob[$3] = $2 }
/^I / { path = $2; sub(/:.*/, "", path); name = $0; sub(/.*["<]/, "", name); included[path] = included[path] name "\n" }
/^C .*"command": / {
  command = $0
  for (k = 1; k <= NF; ++k) if ($k ~ /^-I/ && !($k in known)) { known[$k] = 1; roots[++root_count] = substr($k, 3) }
}
/^C .*"file": / { name = $0; gsub(/.*"file": "|".*/, "", name); commands[name] = commands[name] command "\n" }
/^U / {
  if (!($2 in commands)) { print $2 ": expected its compile command, got none" > "/dev/stderr"; exit 1 }
  split("", seen)
  list = ""
  reach($2)
  out = $2
  gsub("/", "+", out)
  out = FOLDER "/" out
  printf "%s\n%s%s", environment, commands[$2], list > out
  close(out)
}
