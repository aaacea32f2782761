#include "sweep/throw_again.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "base/threads.h"
#include "scene/record/events.h"

namespace headpin::sweep {

namespace {

/// Delay between a sample and its use.
Time delay(const scene::Session& session) {
  return microseconds(session.scenario().rig.delay_s);
}

/// The longest time until a throw is over.
Time longest(const scene::Session& session) {
  constexpr Time kCounting{2'000'000};
  return microseconds(session.scenario().game.ball_back_s) + kCounting;
}

/// When the hand opens.
struct Opening {
  Time time;
  bool moved;  ///< not as recorded: the hand is closed until then

  /// The hand never closes again.
  void change(devices::MouseSample& button) const {
    if (button.device_time >= time) {
      button.trigger = false;
    } else if (moved) {
      button.trigger = true;
    }
  }
  void change(std::vector<devices::Sample>& samples) const {
    for (devices::Sample& sample : samples) {
      if (auto* button = std::get_if<devices::MouseSample>(&sample)) change(*button);
    }
  }
};

/// Adds a sample that opens the hand to those that the player has not used yet.
void add_opening(scene::Player& player, Time time) {
  std::vector<devices::MouseSample>& buttons = player.buttons;
  const auto later =
      std::ranges::upper_bound(buttons, time, {}, &devices::MouseSample::device_time);
  devices::MouseSample opening;
  opening.device_time = time;
  opening.left_thumb = later == buttons.begin() ? player.left_thumb : (later - 1)->left_thumb;
  opening.right_thumb = later == buttons.begin() ? player.right_thumb : (later - 1)->right_thumb;
  buttons.insert(later, opening);
}

/// Whether all balls and skittles sleep, so that nothing falls any more.
bool is_at_rest(const scene::Session& session) {
  const auto sleeps = [&](engine::BodyId body) { return engine::is_asleep(session.world, body); };
  return std::ranges::all_of(session.stage->balls, sleeps) &&
         std::ranges::all_of(session.stage->skittles, sleeps);
}

}  // namespace

Outcome throw_again(const Situation& situation, const Release& release) {
  const scene::Session& before = *situation.before;
  const Opening opening{situation.trigger + release.shift, release.shift != Time{}};
  const Time wait = delay(before);
  Outcome outcome;
  if (opening.time + wait <= before.now()) return outcome;
  scene::Alone alone{.session = before};
  alone.session.player.release_change = release.change;
  alone.let_go = opening.time + wait;
  for (devices::MouseSample& waiting : alone.session.player.buttons) opening.change(waiting);
  scene::Score score;
  const auto is_over = [&] {
    const bool counts = alone.session.game.begun;  // then the rules end it
    return alone.over || (!counts && !score.throws.empty() && is_at_rest(alone.session));
  };
  for (std::size_t i = 0; !is_over(); ++i) {
    std::vector<devices::Sample> samples;
    if (i < situation.samples.size()) samples = situation.samples[i];
    opening.change(samples);
    const Time until = alone.session.next_tick() - wait;
    const bool due = alone.session.now() - wait < opening.time && opening.time <= until;
    if (opening.moved && due) add_opening(alone.session.player, opening.time);
    alone.step(samples);
    for (const scene::Event& event : alone.session.events) {
      if (scene::is_release_of_ball(event) || event.kind == scene::kind::first_contact ||
          event.kind == scene::kind::skittle_down) {
        score.add(event, before.scenario());
      }
    }
  }
  if (score.throws.empty()) return outcome;
  outcome.released = true;
  outcome.thrown = score.throws.front();
  outcome.down = alone.result.felled.value_or(outcome.thrown.felled_by_ball.value_or(0));
  return outcome;
}

std::vector<Outcome> throw_again(const Situation& situation, std::span<const Release> releases,
                                 int jobs, const std::function<void(std::int64_t done)>& check) {
  std::vector<Outcome> outcomes(releases.size());
  std::atomic<std::size_t> taken{0}, done{0};
  std::mutex mutex;
  std::condition_variable ended;
  std::exception_ptr failure;
  std::size_t over = 0;
  const auto work = [&](bool alone) {
    try {
      for (std::size_t i; (i = taken++) < releases.size(); ++done) {
        outcomes[i] = throw_again(situation, releases[i]);
        if (alone) check(static_cast<std::int64_t>(done));
      }
    } catch (...) {
      const std::lock_guard lock(mutex);
      if (!failure) failure = std::current_exception();
      taken = releases.size();
    }
    const std::lock_guard lock(mutex);
    ++over;
    ended.notify_all();
  };
  std::vector<std::jthread> threads = base::begin_threads(jobs, [&] { work(false); });
  if (threads.empty()) work(true);
  std::unique_lock lock(mutex);
  while (over < threads.size()) {
    ended.wait_for(lock, std::chrono::milliseconds(100));
    lock.unlock();
    try {
      check(static_cast<std::int64_t>(done));
    } catch (...) {
      lock.lock();
      if (!failure) failure = std::current_exception();
      lock.unlock();
      taken = releases.size();
    }
    lock.lock();
  }
  lock.unlock();
  threads.clear();
  if (failure) std::rethrow_exception(failure);
  return outcomes;
}

std::optional<Time> Situations::hand_opened(const scene::Session& session) {
  for (const devices::Sample& sample : session.samples) {
    if (const auto* button = std::get_if<devices::MouseSample>(&sample)) {
      buttons_.push_back(*button);
    }
  }
  const auto later = std::ranges::find_if(buttons_, [&](const devices::MouseSample& button) {
    return button.device_time > session.now() - delay(session);
  });
  const auto open = std::find_if(
      buttons_.begin(), later, [](const devices::MouseSample& button) { return !button.trigger; });
  std::optional<Time> opened;
  if (open != later) opened = open->device_time;
  buttons_.erase(buttons_.begin(), later);
  return opened;
}

void Situations::begin(Time trigger) {
  Situation situation;
  situation.trigger = trigger;
  auto before =
      std::make_shared<scene::Session>(scene::on_its_own(recent_.front(), recent_.front().stage));
  before->hashes = false;
  before->world.parameters.keep_ledger = false;
  before->player.velocities = std::make_shared<scene::HandVelocities>();
  situation.before = std::move(before);
  for (std::size_t i = 1; i < recent_.size(); ++i) {
    situation.samples.push_back(recent_[i].samples);
  }
  number_.push_back(score_.throws.size() - 1);
  all_.push_back(std::move(situation));
}

void Situations::tick(const scene::Session& session) {
  const std::optional<Time> opened = hand_opened(session);
  for (const scene::Event& event : session.events) {
    score_.add(event, session.scenario());
    if (!scene::is_release_of_ball(event) || !opened) continue;
    if (recent_.empty() && before_) recent_.push_back(*before_);  // taken in this tick
    if (!recent_.empty()) begin(*opened);
  }
  if (!session.events.empty()) {
    for (std::size_t i = 0; i < all_.size(); ++i) all_[i].thrown = score_.throws[number_[i]];
  }
  for (Situation& situation : all_) {
    if (session.now() > situation.trigger + shift_ + longest(session)) continue;
    situation.samples.push_back(session.samples);
  }
  if (!session.player.held) {
    recent_.clear();
    before_ = session;
    return;
  }
  recent_.push_back(session);
  while (recent_.size() > 1 && recent_[1].now() <= session.now() - shift_) recent_.pop_front();
}

}  // namespace headpin::sweep
