# shellcheck shell=bash
# For scripts to source: the programs in build/release, or for another machine, and the viewer's page. To be sourced at the root.

preset=release
release=build/release
page=viewer/dist/page
machine=$(uname -m)  # for which the programs are
sysroot=             # its libraries lie below this
emulator=()          # runs its programs here

# From here on programs are for the machine $1, as uname or Debian names it: this one's, or ARM64 where this is x86-64.
build_for() {
  local asked=${1/#amd64/x86_64}
  asked=${asked/#arm64/aarch64}
  [[ $asked != "$machine" ]] || return 0
  [[ $asked == aarch64 && $machine == x86_64 ]] || {
    echo "on $machine no programs for $1 are made" >&2
    return 1
  }
  machine=aarch64 preset=arm64 release=build/arm64 sysroot=$PWD/build/sysroot-arm64
  emulator=(qemu-aarch64-static -L "$sysroot")
  if [[ ! -d $sysroot ]] || ! command -v aarch64-linux-gnu-g++ >/dev/null || ! command -v qemu-aarch64-static >/dev/null; then
    echo "what makes programs for ARM64 is not there: run scripts/install_dependencies arm64" >&2
    return 1
  fi
}

# Runs a program that was built.
run_program() {
  "${emulator[@]}" "$release/$1" "${@:2}"
}

# Builds the targets that are given. Uses what is built already; a build that was set up in another way stays so.
build_program() {
  [[ -f $release/CMakeCache.txt ]] || cmake --preset "$preset" -DBUILD_TESTING=OFF -DCMAKE_UNITY_BUILD=ON
  cmake --build "$release" --target "$@"
}

has_osg() {
  grep -q '^OSG_FOUND:INTERNAL=1' "$release/CMakeCache.txt"
}

# Prints the name of what reads OSGB, if it can be built: also if OpenSceneGraph came after the build was set up.
osgb_program() {
  [[ -f $release/CMakeCache.txt ]] || return 0
  if [[ -z $sysroot ]] && ! has_osg && pkg-config --exists openscenegraph-osgDB; then
    cmake "$release" >&2
  fi
  ! has_osg || echo meshhier_osgb
}

# Whether nothing in viewer/ is newer than what its build makes last.
page_is_new() {
  local last=$page/meshhier-ktx2.js.gz
  [[ -s $page/index.html && -s $last ]] &&
    [[ -z $(find viewer -mindepth 1 \( -path viewer/dist -o -path viewer/node_modules -o -path viewer/test \) -prune -o -newer "$last" -print -quit) ]]
}

# Prints why there is no new page, if there is none. One that is new is left as it is, and so are packages that
# scripts/install_dependencies installed.
build_page() {
  if page_is_new; then
    return
  elif ! command -v npm >/dev/null; then
    echo "npm is not there (Debian: packages nodejs and npm)"
  elif ! cmp -s viewer/package-lock.json viewer/node_modules/.installed-lock.json &&
    ! npm ci --prefix viewer --ignore-scripts --no-audit --no-fund --loglevel=error >&2; then
    echo "npm ci failed in viewer/, see above"
  elif ! npm run --silent --prefix viewer build >&2; then
    echo "npm run build failed in viewer/, see above"
  elif [[ ! -f $page/index.html ]]; then
    echo "npm run build made no $page/index.html"
  fi
}

# The same where there must be a page: ends with 1 if there is none.
require_page() {
  local missing
  missing=$(build_page)
  [[ -z $missing ]] || {
    echo "the viewer's page cannot be made: $missing; scripts/install_dependencies page installs what it needs" >&2
    return 1
  }
}

# Packs its input: equal bytes for equal ones, whatever the processors (-T0 does not promise that).
pack() {
  xz -6 -T2 --block-size=32MiB
}
