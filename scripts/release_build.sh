# shellcheck shell=bash
# For scripts/install, scripts/package and scripts/sample: the program in build/release and the viewer's page. To be sourced at the root.

release=build/release

# Builds the targets that are given. Uses what is built already; a build that was set up in another way stays so.
build_program() {
  [[ -f $release/CMakeCache.txt ]] || cmake --preset release -DBUILD_TESTING=OFF -DCMAKE_UNITY_BUILD=ON
  cmake --build "$release" --target "$@"
}

# Prints why there is no new page, if there is none. Packages that scripts/install_dependencies installed are used.
build_page() {
  if ! command -v npm >/dev/null; then
    echo "npm is not there (Debian: packages nodejs and npm)"
  elif ! cmp -s viewer/package-lock.json viewer/node_modules/.installed-lock.json &&
    ! npm ci --prefix viewer --ignore-scripts --no-audit --no-fund --loglevel=error >&2; then
    echo "npm ci failed in viewer/, see above"
  elif ! npm run --prefix viewer build >&2; then
    echo "npm run build failed in viewer/, see above"
  elif [[ ! -f viewer/dist/page/index.html ]]; then
    echo "npm run build made no viewer/dist/page/index.html"
  fi
}
