#include "base/lock.h"

#include <cerrno>

#include <sys/file.h>

namespace headpin::base {

bool lock(int descriptor) {
  // A file system without locks is no reason to refuse work.
  return flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
}

bool lock_for_sure(int descriptor) {
  return flock(descriptor, LOCK_EX | LOCK_NB) == 0;
}

}  // namespace headpin::base
