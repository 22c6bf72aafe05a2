# shellcheck shell=bash
# For scripts/package to source: wheels of python/. To be sourced at the root.

# Builds what is in the folder $1 into $2, without a network.
build_wheel() {
  "${PYTHON:-/usr/bin/python3}" -m pip wheel --quiet --no-deps --no-index --no-build-isolation --wheel-dir "$2" "$1" >&2
}

# Makes the wheel of pure Python in the folder $1, with the viewer's scripts for notebooks; and of each further argument, a portable archive,
# one that carries it and has the command meshhier.
make_wheels() {
  local to=$1 work archive
  shift
  work=$(mktemp -d)
  cp -r python "$work/python"
  rm -rf "$work"/python/{setup.py,build,*.egg-info}
  mkdir "$work/python/meshhier/viewer"
  cp viewer/dist/page/meshhier-{viewer,ktx2}.js.gz "$work/python/meshhier/viewer"
  build_wheel "$work/python" "$to"
  rm -rf "$work/python/meshhier/viewer"  # the archives have it
  printf '\n[project.scripts]\nmeshhier = "meshhier.program:main"\n' >>"$work/python/pyproject.toml"
  for archive in "$@"; do
    make_wheel_with "$archive" "$work/python" "$to"
  done
  rm -rf "$work"
}

# Makes a wheel in the folder $3 of what is in $2, with the portable archive $1. The program brings its libraries, libc and the loader among
# them, behind a static launcher: it runs where Linux does, and the tags are the oldest ones that pip knows on both kinds of processors, of
# systems with glibc, and of those with musl, as Alpine.
make_wheel_with() {
  local archive=$1 from=$2 to=$3 machine
  machine=$(sed 's/.*-linux-//; s/\.tar\.xz$//' <<<"$archive")
  rm -rf "$from/build" "$from/meshhier/program"
  mkdir "$from/meshhier/program"
  tar --extract --xz --file "$archive" --directory "$from/meshhier/program" --strip-components=1
  rm -rf "$from/meshhier/program/share/doc/meshhier/docs"
  cat >"$from/setup.py" <<END
from setuptools import setup
from wheel.bdist_wheel import bdist_wheel


class Wheel(bdist_wheel):
    def get_tag(self):
        return "py3", "none", "manylinux2014_$machine.musllinux_1_1_$machine"


setup(cmdclass={"bdist_wheel": Wheel})
END
  build_wheel "$from" "$to"
}
