// Loaded before the C library: no thread can be begun, as where a limit on them is reached; or only
// the first THREADS of them.

#include <atomic>
#include <cerrno>
#include <cstdlib>

#include <dlfcn.h>
#include <pthread.h>

extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes,
                              void* (*work)(void*), void* with) noexcept {
  static std::atomic<int> begun = 0;
  const char* const most = std::getenv("THREADS");
  if (most == nullptr || begun++ >= std::atoi(most)) return EAGAIN;
  using Create = int (*)(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  return reinterpret_cast<Create>(dlsym(RTLD_NEXT, "pthread_create"))(thread, attributes, work,
                                                                      with);
}
