# shellcheck shell=bash
# For scripts/package to source: the archive that runs on any Linux of x86-64. To be sourced at the root, with release_build.sh.
#
#   bin/meshhier, bin/meshgen     packaging/portable/launcher.cpp, linked statically
#   lib/meshhier/                 the programs, all libraries that they load, and the loader
#   share/meshhier/               the page, example configs, PROJ's data
#   share/doc/meshhier/           documents; licences/ has those of the libraries, and which Debian packages they are of

loader=/lib64/ld-linux-x86-64.so.2
launcher=$release/meshhier_launcher

# Prints NAME PATH of each library that the given files load.
libraries_of() {
  local listed
  listed=$(ldd "$@")
  ! grep "not found" <<<"$listed" >&2 || return 1
  awk '$2 == "=>" && $3 ~ /^\// { print $1, $3 }' <<<"$listed" | LC_ALL=C sort -u
}

# The Debian package that a file is of, wherever links in its path lead.
package_of() {
  local path
  for path in "$1" "$(realpath "$1")" "/usr$(realpath "$1")" "$(realpath "$1" | sed 's|^/usr||')"; do
    dpkg-query --search "$path" 2>/dev/null | sed 's/: .*//; s/,.*//' | head -n 1 | grep . && return
  done
  echo "package: no Debian package has $1" >&2
  return 1
}

# Their licences, and where their sources are.
put_licences() {
  local to=$1 file package
  shift
  mkdir -p "$to"
  for file in "$@"; do
    package_of "$file"
  done | LC_ALL=C sort -u >"$to/.packages"
  {
    echo "The libraries and data beside the program are Debian's, unchanged. Their sources, by package and version, are at"
    echo "https://snapshot.debian.org; the licence of each is beside this file."
    echo
    while read -r package; do
      cp "/usr/share/doc/${package%%:*}/copyright" "$to/${package%%:*}.txt"
      dpkg-query --show --showformat '${Package} ${Version}, source ${source:Package} ${source:Version}\n' "$package"
    done <"$to/.packages"
  } >"$to/README.txt"
  rm "$to/.packages"
}

# Makes the folder $1 of what is built in $release, and the page.
make_portable_folder() {
  local root=$1 libraries=$1/lib/meshhier name proj library path
  local -a files
  rm -rf "$root"
  cmake --install "$release" --prefix "$root" --component Unspecified >&2
  mkdir -p "$libraries"
  mv "$root/bin/meshhier" "$libraries/meshhier"
  cp "$release/meshgen" "$libraries/meshgen"
  # It is loaded when it is needed, by the name to which the one for compilers is a link, as CMakeLists.txt has it.
  proj=$(ldconfig -p | awk '$1 == "libproj.so" && !found++ { print $NF }')
  proj=$(dirname "$proj")/$(readlink "$proj")
  files=("$proj" "$loader" /usr/share/proj/proj.db)
  cp -L "$proj" "$libraries/"
  while read -r library path; do
    cp -L "$path" "$libraries/$library"
    files+=("$path")
  done < <(libraries_of "$libraries/meshhier" "$libraries/meshgen" "$proj")
  cp -L "$loader" "$libraries/"
  strip "$libraries/meshhier" "$libraries/meshgen"
  for name in meshhier meshgen; do
    cp "$launcher" "$root/bin/$name"
  done
  mkdir -p "$root/share/meshhier/proj"
  cp -RL /usr/share/proj/. "$root/share/meshhier/proj/"
  put_licences "$root/share/doc/meshhier/licences" "${files[@]}"
  cp packaging/portable/README.txt LICENSE "$root/"
  chmod -R u=rwX,go=rX "$root"
}

# Packs the folder $1 into $2; equal content gives equal bytes.
pack_portable_folder() {
  tar --create --directory "$(dirname "$1")" --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner \
    --format=gnu "$(basename "$1")" | pack >"$2"
}
