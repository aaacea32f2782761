#include "render/label_pass.h"

#include <algorithm>
#include <array>
#include <limits>

#include "render/shaders.h"

namespace headpin::render {

Labels LabelPass::draw(const DrawList& list, const View& view, std::span<const View> shown) {
  if (program_ == nullptr) {
    program_ = std::make_unique<Program>(gl_, shaders::kDepthVertex, shaders::kLabelFragment);
  }
  if (target_ == nullptr || !target_->fits(view.width, view.height)) {
    target_ = std::make_unique<Target>(gl_, GL_R32UI, view.width, view.height);
  }
  target_->use();
  const std::array<GLuint, 4> nothing{};
  gl_.ClearBufferuiv(GL_COLOR, 0, nothing.data());
  gl_.Clear(GL_DEPTH_BUFFER_BIT);
  program_->use();
  const Mat4 clip = world_to_clip(view);
  const std::vector<double> sizes = meshes_.sizes_seen(list, shown);
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const DrawItem& item = list.items[i];
    const Mat4 mesh_to_clip = clip * matrix(item.X_WG, item.scale);
    program_->set("to_clip", mesh_to_clip);
    program_->set("id", item.id);
    meshes_.draw(meshes_.seen(item, sizes[i]), mesh_to_clip);
  }

  const auto width = static_cast<std::size_t>(view.width);
  const auto height = static_cast<std::size_t>(view.height);
  Labels labels{view.width, view.height, std::vector<std::uint32_t>(width * height),
                std::vector<float>(width * height)};
  gl_.ReadPixels(0, 0, view.width, view.height, GL_RED_INTEGER, GL_UNSIGNED_INT, labels.id.data());
  gl_.ReadPixels(0, 0, view.width, view.height, GL_DEPTH_COMPONENT, GL_FLOAT, labels.depth.data());
  for (std::size_t y = 0; y < height / 2; ++y) {  // rows come from the bottom
    const auto swap_rows = [&](auto& rows) {
      const auto low = rows.begin() + static_cast<std::ptrdiff_t>(y * width);
      const auto high = rows.begin() + static_cast<std::ptrdiff_t>((height - 1 - y) * width);
      std::swap_ranges(low, low + static_cast<std::ptrdiff_t>(width), high);
    };
    swap_rows(labels.id);
    swap_rows(labels.depth);
  }
  const double n = view.frustum.near, f = view.frustum.far;
  for (float& d : labels.depth) {
    d = d == 1.0F ? std::numeric_limits<float>::infinity()
                  : static_cast<float>(n * f / (f - static_cast<double>(d) * (f - n)));
  }
  return labels;
}

}  // namespace headpin::render
