# shellcheck shell=bash
# For scripts/package to source: the archive that runs on any Linux of one machine. To be sourced at the root, with release_build.sh.
#
#   bin/meshhier, bin/meshgen     packaging/portable/launcher.cpp, linked statically
#   lib/meshhier/                 the programs, all libraries that they load, and the loader
#   share/meshhier/               the page, example configs, PROJ's data
#   share/doc/meshhier/           documents; licences/ has those of the libraries, and which Debian packages they are of

declare -A loader_of=([x86_64]=/lib64/ld-linux-x86-64.so.2 [aarch64]=/lib/ld-linux-aarch64.so.1)

# As ldd, also for files of another machine.
list_libraries() {
  if [[ -z $sysroot ]]; then
    ldd "$@"
    return
  fi
  local file folders=$sysroot/lib/$machine-linux-gnu:$sysroot/usr/lib/$machine-linux-gnu
  for file in "$@"; do
    "${emulator[@]}" "$sysroot${loader_of[$machine]}" --library-path "$folders" --list "$file"
  done
}

# Prints NAME PATH of each library that the given files load.
libraries_of() {
  local listed
  listed=$(list_libraries "$@")
  ! grep "not found" <<<"$listed" >&2 || return 1
  awk '$1 !~ /^\// && $2 == "=>" && $3 ~ /^\// { print $1, $3 }' <<<"$listed" | LC_ALL=C sort -u
}

# dpkg-query, of the packages that the programs are built with.
query() {
  dpkg-query ${sysroot:+--admindir="$sysroot/var/lib/dpkg"} "$@"
}

# The Debian package that a file is of, wherever links in its path lead.
package_of() {
  local path own real
  own=${1#"$sysroot"}
  real=$(realpath "$1")
  real=${real#"$sysroot"}
  for path in "$own" "$real" "/usr$real" "${real#/usr}"; do
    query --search "$path" 2>/dev/null | sed 's/: .*//; s/,.*//' | head -n 1 | grep . && return
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
      cp "$sysroot/usr/share/doc/${package%%:*}/copyright" "$to/${package%%:*}.txt"
      query --show --showformat '${Package} ${Version}, source ${source:Package} ${source:Version}\n' "$package"
    done <"$to/.packages"
  } >"$to/README.txt"
  rm "$to/.packages"
}

# Makes the folder $1 of what is built in $release, and the page.
make_portable_folder() {
  local root=$1 libraries=$1/lib/meshhier loader=$sysroot${loader_of[$machine]} name proj library path strip=strip
  local -a files
  rm -rf "$root"
  cmake --install "$release" --prefix "$root" --component Unspecified >&2
  mkdir -p "$libraries"
  mv "$root/bin/meshhier" "$libraries/meshhier"
  cp "$release/meshgen" "$libraries/meshgen"
  # It is loaded when it is needed, by the name to which the one for compilers is a link, as CMakeLists.txt has it.
  proj=$sysroot/usr/lib/$machine-linux-gnu/libproj.so
  proj=$(dirname "$proj")/$(readlink "$proj")
  files=("$proj" "$loader" "$sysroot/usr/share/proj/proj.db")
  cp -L "$proj" "$libraries/"
  while read -r library path; do
    cp -L "$path" "$libraries/$library"
    files+=("$path")
  done < <(libraries_of "$libraries/meshhier" "$libraries/meshgen" "$proj")
  cp -L "$loader" "$libraries/"
  [[ -z $sysroot ]] || strip=$machine-linux-gnu-strip
  "$strip" "$libraries/meshhier" "$libraries/meshgen"
  for name in meshhier meshgen; do
    cp "$release/meshhier_launcher" "$root/bin/$name"
  done
  mkdir -p "$root/share/meshhier/proj"
  cp -RL "$sysroot/usr/share/proj/." "$root/share/meshhier/proj/"
  put_licences "$root/share/doc/meshhier/licences" "${files[@]}"
  sed "s/MACHINE/$machine/" packaging/portable/README.txt >"$root/README.txt"
  cp LICENSE "$root/"
  chmod -R u=rwX,go=rX "$root"
}

# Packs the folder $1 into $2; equal content gives equal bytes.
pack_portable_folder() {
  tar --create --directory "$(dirname "$1")" --sort=name --mtime="@$SOURCE_DATE_EPOCH" --owner=0 --group=0 --numeric-owner \
    --format=gnu "$(basename "$1")" | pack >"$2"
}
