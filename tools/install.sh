#!/bin/sh
# Install packages with pip and show what it is doing: one line per file that it fetches, and the time that it took.
# All that pip says is in the log; its end is shown if pip fails.
# usage: install.sh PYTHON LOG TITLE ARGUMENT...
set -u
python=$1 log=$2 title=$3
shift 3
began=$(date +%s)
echo "$title"
{
    "$python" -m pip install --disable-pip-version-check --progress-bar off "$@" 2>&1
    echo "pip ended with $?"
} | tee "$log" | {
    # Not awk, which on some systems waits for a full buffer before it prints the first line.
    code=1
    while IFS= read -r line; do
        case $line in
        *"Downloading "* | *"Using cached "*)
            file=${line##*[/ ]}
            case $line in
            *" ("*")") size="(${line##*(}" && file=${line% (*} && file=${file##*[/ ]} ;;
            *) size="" ;;
            esac
            printf '  %-40.40s %s\n' "${file%%-[0-9]*}" "$size"
            ;;
        "Installing collected packages"*) echo "  installing them" ;;
        "pip ended with "*) code=${line##* } ;;
        esac
    done
    exit "$code"
}
code=$?
if [ $code -ne 0 ]; then
    tail -n 20 "$log" >&2
    echo "error: pip has failed, see $log; check the network and the disk, then give the same command again" >&2
    exit $code
fi
echo "  done after $(($(date +%s) - began)) s"
