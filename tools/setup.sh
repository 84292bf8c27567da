# shellcheck shell=bash
# Shared by ./fly and ./check: packages, configuring, building. Sourced by bash in the root of the project.
export DEBIAN_FRONTEND=noninteractive TZ="${TZ:-UTC}"

# Each argument is a line.
say() {
    printf '%s\n' "$@"
}

fail() {
    printf '%s\n' "$@" >&2
    exit 1
}

# packages_for build|test: the names; test includes build.
packages_for() {
    awk -v kind="$1" '!/^#/ && NF && (kind == "test" || $2 == kind) { print $1 }' tools/packages.txt
}

packages_missing() {
    local package
    for package in $(packages_for "$1"); do
        [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || say "$package"
    done
}

is_debian_like() {
    command -v apt-get >/dev/null && command -v dpkg-query >/dev/null && (
        # shellcheck source=/dev/null
        . /etc/os-release && [[ " $ID ${ID_LIKE:-} " == *" debian "* || "$ID" == ubuntu ]]
    )
}

as_root() {
    if [ "$(id -u)" = 0 ]; then
        "$@"
    else
        sudo DEBIAN_FRONTEND=noninteractive "$@"
    fi
}

# install_packages build|test: asks apt only where something is missing.
install_packages() {
    if ! is_debian_like; then
        install_by_hand "$1"
        return
    fi
    local missing
    mapfile -t missing < <(packages_missing "$1")
    [ ${#missing[@]} -eq 0 ] && return
    say "Installing: ${missing[*]}"
    [ "$(id -u)" = 0 ] || command -v sudo >/dev/null ||
        fail "That needs root, and there is no sudo. As root: apt-get install ${missing[*]}"
    as_root apt-get update -qq || say "apt-get update failed; trying with the package lists at hand." >&2
    as_root apt-get install -y --no-install-recommends -o Dpkg::Use-Pty=0 -qq "${missing[@]}" >"$setup_log" 2>&1 || {
        tail -n 30 "$setup_log" >&2
        fail "apt-get could not install the packages above; its whole output is in $setup_log."
    }
}

# Where there is no apt: the libraries are looked for with pkg-config and the names printed if one is not there.
install_by_hand() {
    local module tool absent=()
    for tool in cmake ninja cc c++ pkg-config; do
        command -v "$tool" >/dev/null || absent+=("$tool")
    done
    for module in epoxy glfw3 OpenImageIO geographiclib libtiff-4 minizip zlib libcjson inih hidapi-hidraw \
        libusb-1.0; do
        pkg-config --exists "$module" 2>/dev/null || absent+=("$module")
    done
    [ ${#absent[@]} -eq 0 ] && return
    say "This is neither Debian nor Ubuntu, so nothing is installed. Not found: ${absent[*]}." \
        "Overfly needs what these Debian packages hold:" >&2
    packages_for "$1" >&2
    fail "Install them in this system's way and run this again."
}

# build_preset PRESET [CMAKE OPTION]... -- [TARGET]...
build_preset() {
    local preset=$1 options=()
    shift
    while [ $# -gt 0 ] && [ "$1" != -- ]; do
        options+=("$1")
        shift
    done
    shift
    cmake --preset "$preset" "${options[@]}" >"$setup_log" 2>&1 || {
        cat "$setup_log" >&2
        say "Configuring the preset $preset failed." >&2
        return 1
    }
    cmake --build --preset "$preset" ${1:+--target "$@"}
}

mkdir -p build
setup_log=$PWD/build/setup.log
