// Loaded before the C library: no thread can be begun, as where a limit on them is reached.

#include <cerrno>

#include <pthread.h>

extern "C" int pthread_create(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*) noexcept {
  return EAGAIN;
}
