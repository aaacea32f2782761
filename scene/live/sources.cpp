#include "scene/live/sources.h"

#include <algorithm>
#include <utility>

#include "devices/base/mouse3d.h"
#include "devices/base/sources.h"

namespace headpin::scene {

LiveSources::LiveSources(std::vector<devices::OpenSource> sources) : each_(std::move(sources)) {
  std::vector<devices::Source*> all;
  for (const devices::OpenSource& one : each_) all.push_back(one.source.get());
  merged_ = std::make_unique<devices::MergedSource>(std::move(all));
  if (std::ranges::any_of(each_, &devices::OpenSource::has_stylus)) {
    merged_ = std::make_unique<devices::StylusMouse>(std::move(merged_));
  }
}

void LiveSources::start() const {
  for (const devices::OpenSource& one : each_) one.source->start();
}

}  // namespace headpin::scene
