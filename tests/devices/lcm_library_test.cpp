// What becomes of answers of liblcm that are rare: its functions here are the test's own while it says so.

#include <cerrno>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <gtest/gtest.h>
#include <lcm/lcm.h>
#include <poll.h>

#include "devices/lcm/link.h"
#include "devices/lcm/source.h"
#include "tests/support/folder.h"
#include "tests/support/lcm_server.h"

#ifdef HEADPIN_SANITIZED
#include <sanitizer/lsan_interface.h>
#endif

namespace headpin::devices {
namespace {

/// What liblcm is asked for, and what it answers; without an answer, its own.
struct LibraryAnswers {
  std::function<int(lcm_t*)> to_publish, to_handle;
  std::vector<int> capacities;
  int unsubscribed = 0;
};
LibraryAnswers* library = nullptr;

template <typename Function>
Function* of_library(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace
}  // namespace headpin::devices

using headpin::devices::library;  // NOLINT: the functions below are liblcm's
using headpin::devices::of_library;

extern "C" {

int lcm_publish(lcm_t* lcm, const char* channel, const void* data, unsigned size) {
  if (library != nullptr && library->to_publish) return library->to_publish(lcm);
  return of_library<decltype(lcm_publish)>("lcm_publish")(lcm, channel, data, size);
}

int lcm_handle_timeout(lcm_t* lcm, int timeout_ms) {
  if (library != nullptr && library->to_handle) return library->to_handle(lcm);
  return of_library<decltype(lcm_handle_timeout)>("lcm_handle_timeout")(lcm, timeout_ms);
}

int lcm_unsubscribe(lcm_t* lcm, lcm_subscription_t* subscription) {
  if (library != nullptr) ++library->unsubscribed;
  return of_library<decltype(lcm_unsubscribe)>("lcm_unsubscribe")(lcm, subscription);
}

int lcm_subscription_set_queue_capacity(lcm_subscription_t* subscription, int messages) {
  if (library != nullptr) library->capacities.push_back(messages);
  return of_library<decltype(lcm_subscription_set_queue_capacity)>(
      "lcm_subscription_set_queue_capacity")(subscription, messages);
}
}

namespace headpin::devices {
namespace {

const std::string kServerGone = ": the LCM server has closed the connection";

class LcmLibraryTest : public testing::Test {
 protected:
  LcmLibraryTest() { library = &answers_; }
  ~LcmLibraryTest() override { library = nullptr; }

  static std::string publish(LcmLink& link) {
    return complaint([&] { link.publish(Sample(TrackerSample{})); });
  }
  static void close(LocalLcmServer& server, lcm_t* lcm) {
    server.close_all();
    pollfd state{lcm_get_fileno(lcm), POLLRDHUP, 0};
    while (poll(&state, 1, -1) != 1) continue;
  }

  LibraryAnswers answers_;
#ifdef HEADPIN_SANITIZED
  const __lsan::ScopedDisabler liblcm_leaks_;  // when it is closed without its server
#endif
};

TEST_F(LcmLibraryTest, ASignalWhilePublishingIsNoFailureAndAFailureIsNamed) {
  LcmLink link("memq://");
  int calls = 0;
  answers_.to_publish = [&](lcm_t*) {
    errno = EINTR;
    return ++calls < 3 ? -1 : 0;
  };
  EXPECT_EQ(publish(link), "");
  EXPECT_EQ(calls, 3);
  answers_.to_publish = [](lcm_t*) { return errno = ENOBUFS, -1; };
  EXPECT_EQ(publish(link), "cannot publish on TRACKER at memq://: No buffer space available");
  answers_.to_publish = [](lcm_t*) { return -1; };
  EXPECT_EQ(publish(link), "cannot publish on TRACKER at memq://: refused by LCM");
}

// liblcm would connect again and send to whoever is there then.
TEST_F(LcmLibraryTest, NothingIsPublishedOnceTheServerIsGone) {
  LocalLcmServer server(true);
  LcmLink link(server.url());
  int calls = 0;
  answers_.to_publish = [&](lcm_t* lcm) {
    ++calls;
    close(server, lcm);
    return 0;
  };
  EXPECT_EQ(publish(link), "");
  EXPECT_EQ(publish(link), server.url() + kServerGone);
  EXPECT_EQ(calls, 1);
}

TEST_F(LcmLibraryTest, AServerThatGoesWhileItIsAskedIsNamed) {
  LocalLcmServer server(true), other(true);
  LcmLink to(server.url()), from(other.url());
  answers_.to_publish = [&](lcm_t* lcm) {
    close(server, lcm);
    return errno = EPIPE, -1;
  };
  EXPECT_EQ(publish(to), server.url() + kServerGone);
  Clocks clocks;
  std::optional<LcmSource> source(std::in_place, from, clocks);
  answers_.to_handle = [&](lcm_t* lcm) {
    close(other, lcm);
    return -1;
  };
  EXPECT_EQ(complaint([&] { source->receive(Time{1000}); }), other.url() + kServerGone);
  source.reset();
  EXPECT_EQ(answers_.unsubscribed, 0) << "it would connect again";
}

TEST_F(LcmLibraryTest, AServerThatAnswersOnceOnlyIsNoLink) {
  const LocalLcmServer server(true, 1);
  EXPECT_EQ(complaint([&] { LcmLink link(server.url()); }), server.url() + kServerGone);
}

TEST_F(LcmLibraryTest, AnyOtherFailureToReceiveEndsTheSession) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  answers_.to_handle = [](lcm_t*) { return errno = EINTR, -1; };
  EXPECT_EQ(complaint([&] { source.receive(Time{1000}); }), "");
  answers_.to_handle = [](lcm_t*) { return errno = EIO, -1; };
  EXPECT_EQ(complaint([&] { source.receive(Time{2000}); }), "LCM stopped: memq://");
}

TEST_F(LcmLibraryTest, AsManyMessagesWaitAndAreTakenAtOnceAsTheQueueHolds) {
  LcmLink link("memq://");
  Clocks clocks;
  {
    LcmSource source(link, clocks, 10);
    EXPECT_EQ(answers_.capacities, (std::vector<int>{10, 10}));
    int calls = 0;
    answers_.to_handle = [&](lcm_t*) { return ++calls < 1000 ? 1 : 0; };
    source.receive(Time{1000});
    EXPECT_EQ(calls, 10);
    answers_.to_handle = nullptr;
  }
  EXPECT_EQ(answers_.unsubscribed, 2) << "so that nobody calls what is gone";
}

TEST_F(LcmLibraryTest, WhoBeginsToListenDiscardsWhatWaits) {
  LcmLink link("memq://");
  Clocks clocks;
  LcmSource source(link, clocks);
  EXPECT_EQ(publish(link), "");
  source.listen();
  EXPECT_EQ(publish(link), "");
  source.receive(Time{1000});
  EXPECT_EQ(source.intake().counts().received, 1);
}

}  // namespace
}  // namespace headpin::devices
