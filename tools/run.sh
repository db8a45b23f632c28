#!/bin/sh
# run.sh [NAME=VALUE ...] command [arguments]
# Run a command without what a sourced ROS distribution, an active environment or an outer make put
# into the shell: the wheels bring a ROS of their own, and two of them in one process do not mix.
# Byte-code is written, whatever the shell says: each of many short processes would make it anew.
foreign="${AMENT_PREFIX_PATH:-}:${COLCON_PREFIX_PATH:-}:${VIRTUAL_ENV:-}"

# Drop the entries of a colon-separated list that lie in one of the foreign prefixes.
native() {
    printf '%s' "$1" | awk -v RS=: -v prefixes="$foreign" '
        BEGIN { count = split(prefixes, prefix, ":") }
        {
            for (i = 1; i <= count; i++)
                if (prefix[i] != "" && index($0 "/", prefix[i] "/") == 1) next
            printf "%s%s", separator, $0
            separator = ":"
        }'
}
PATH=$(native "$PATH")
export PATH
if [ -n "${LD_LIBRARY_PATH:-}" ]; then
    LD_LIBRARY_PATH=$(native "$LD_LIBRARY_PATH")
    export LD_LIBRARY_PATH
fi
unset AMENT_PREFIX_PATH CMAKE_PREFIX_PATH COLCON_PREFIX_PATH PYTHONPATH PYTHONHOME VIRTUAL_ENV \
    ROS_DISTRO ROS_VERSION ROS_PYTHON_VERSION ROS_ETC_DIR ROS_PACKAGE_PATH RMW_IMPLEMENTATION \
    _ROS_WHEELS_BOOTSTRAP_COMPLETE NUMBA_DISABLE_JIT PYTHONDONTWRITEBYTECODE MAKEFLAGS MFLAGS MAKELEVEL
exec env "$@"
