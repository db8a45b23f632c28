#!/bin/sh
# find_python.sh environment [interpreter]
# Print the path of a Python that the wheels of ROS 2 serve (CPython 3.10 to 3.13), or say what is
# missing and the command that installs it. Without an interpreter named, the one that the
# environment was made from comes first, so that it is not made anew from another.
fit='import sys
ok = sys.implementation.name == "cpython" and (3, 10) <= sys.version_info[:2] < (3, 14)
path = getattr(sys, "_base_executable", "") or sys.executable
print("%s %d.%d.%d %s" % ((ok,) + sys.version_info[:3] + (path,)))'

install_command() {
    if command -v apt-get >/dev/null; then
        echo "sudo apt-get install python3 python3-venv python3-dev"
    elif command -v dnf >/dev/null; then
        echo "sudo dnf install python3.12 python3.12-devel"
    elif command -v zypper >/dev/null; then
        echo "sudo zypper install python312 python312-devel"
    else
        echo "install CPython 3.12 from https://www.python.org/downloads/"
    fi
}

if [ -n "${2:-}" ]; then
    named=$2
    set -- "$2"
else
    named=
    set -- "$1/bin/python" .venv/bin/python python3 python3.12 python3.13 python3.11 python3.10 python
fi
seen=
for candidate; do
    if ! answer=$("$candidate" -I -S -c "$fit" 2>/dev/null); then
        seen=${named:+it does not run}
        continue
    fi
    version=${answer#* }
    path=${version#* }
    version=${version%% *}
    case $answer in
        True*)
            printf '%s\n' "$path"
            exit 0
            ;;
    esac
    seen="$seen${seen:+, }$candidate is $version"
done
{
    echo "setup: ${named:+PYTHON=$named cannot be used: }CPython 3.10 to 3.13 is needed${seen:+ ($seen)}"
    echo "setup: this installs one: $(install_command)"
    echo "setup: one elsewhere is named so: make setup PYTHON=/path/to/python3.12"
} >&2
exit 1
