# The commands of a Markdown document, one a line, as LINE<tab>COMMAND: of its sh blocks, of indented blocks, and of code within its text,
# which is a command where it begins with paracal. A line of a block that names the program and is no command is an error. A line of a block that
# ends with a backslash is joined with the next.
function is_command(text) {
  return text ~ /^(paracal|cmake|ctest|npm|node|linuxcnc|sudo|mpirun|srun|apt|cat|cd|sh|man)( |$)/ || text ~ /^(\.\/|\.ci\/|tools\/|build\/)/ || text ~ /^[A-Z_]+=[^ ]* /
}
function emit(text) { sub(/^ +/, "", text); print NR "\t" text }
function complain(text) {
  print FILENAME ":" NR ": expected a command, got " text > "/dev/stderr"
  failed = 1
}
begun != "" { sub(/^ +/, ""); $0 = begun $0; begun = "" }
/\\$/ && (is_shell || (!inside && /^    / && (was_blank || in_block))) { begun = substr($0, 1, length($0) - 1); next }
/^ *```/ { inside = !inside; is_shell = inside && $0 ~ /^ *```sh$/; was_blank = 0; next }
inside {
  if (!is_shell || $0 ~ /^ *(#|$)/) next
  is_command($0) ? emit($0) : complain($0)
  next
}
/^    / && (was_blank || in_block) {
  in_block = 1
  text = $0
  sub(/^ +/, "", text)
  if (is_command(text)) emit(text)
  else if (text ~ /(^|[|;&] *)paracal [a-z]/) complain(text)
  next
}
{
  was_blank = $0 ~ /^ *$/
  if (!was_blank) in_block = 0
  rest = $0
  while (match(rest, /`paracal [^`]*`/)) {
    text = substr(rest, RSTART + 1, RLENGTH - 2)
    rest = substr(rest, RSTART + RLENGTH)
    if (text ~ /^paracal [a-z-]+$/) text = text " --help  # a mention"
    emit(text)
  }
}
END { exit failed }
