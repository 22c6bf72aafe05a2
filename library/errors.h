// Failures of the project as failures of the library.
#pragma once

#include "base/error.h"
#include "library/include/meshhier/meshhier.h"

#include <exception>
#include <new>

namespace meshhier::v1 {

/// Calls `run` and returns what it does; any exception that it throws becomes a v1::Error.
template <class Run>
auto translated(const Run& run) {
  try {
    return run();
  } catch (const Error&) {
    throw;
  } catch (const meshhier::Error& error) {
    throw Error(static_cast<Failure>(error.code()), error.what());
  } catch (const std::bad_alloc&) {
    throw Error(Failure::budget, "the system has no more memory");
  } catch (const std::exception& error) {
    throw Error(Failure::internal, error.what());
  }
}

}  // namespace meshhier::v1
