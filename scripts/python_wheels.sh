# shellcheck shell=bash
# For scripts/package to source: wheels of python/. To be sourced at the root.

# Builds what is in the folder $1 into $2, without a network.
build_wheel() {
  "${PYTHON:-/usr/bin/python3}" -m pip wheel --quiet --no-deps --no-index --no-build-isolation --wheel-dir "$2" "$1" >&2
}

# Makes the wheel of pure Python, and one that carries the portable archive $1 and has the command meshhier, in the folder $2.
make_wheels() {
  local archive=$1 to=$2 work
  work=$(mktemp -d)
  cp -r python "$work/python"
  build_wheel "$work/python" "$to"
  rm -rf "$work/python/build"
  mkdir "$work/python/meshhier/program"
  tar --extract --xz --file "$archive" --directory "$work/python/meshhier/program" --strip-components=1
  rm -rf "$work/python/meshhier/program/share/doc/meshhier/docs"
  printf '\n[project.scripts]\nmeshhier = "meshhier.program:main"\n' >>"$work/python/pyproject.toml"
  printf '[bdist_wheel]\nplat_name = manylinux2014_x86_64\n' >"$work/python/setup.cfg"
  build_wheel "$work/python" "$to"
  rm -rf "$work"
}
