#include "geodesy/proj_library.h"

namespace meshhier::geodesy::proj {

const Library& library() {
  static const Library loaded{
      storage::SharedLibrary(MESHHIER_PROJ_LIBRARY, "install the package " MESHHIER_PROJ_PACKAGE)};
  return loaded;
}

}  // namespace meshhier::geodesy::proj
