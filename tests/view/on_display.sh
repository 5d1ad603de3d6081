#!/bin/sh
# on_display.sh COMMAND ...: runs a command on a virtual display of its own and returns its exit code. The X server itself
# chooses a free number, so that displays of tests that run at the same time do not collide. Without -noreset the server
# would restart each time its last client disconnects, and would then refuse a client that is just connecting.
folder=$(mktemp -d) || exit 1
mkfifo "$folder/number" || exit 1
Xvfb -displayfd 3 -noreset -nolisten tcp -screen 0 1280x800x24 3>"$folder/number" 2>"$folder/messages" &
server=$!
trap 'kill $server 2>/dev/null; wait $server 2>/dev/null; rm -r "$folder"' EXIT
if ! read -r number <"$folder/number"; then
  cat "$folder/messages" >&2
  exit 1
fi
DISPLAY=:$number "$@"
