#include <array>
#include <limits>

#include "render/passes.h"

namespace headpin::render {

Labels Renderer::labels(const DrawList& list, const View& view, std::span<const View> shown) {
  Impl& r = *impl_;
  const Gl& gl = r.gl;
  r.context->make_current();
  r.check(list, view);
  r.start();
  if (r.label == nullptr) {
    r.label = std::make_unique<Program>(gl, shaders::kDepthVertex, shaders::kLabelFragment);
  }
  if (r.label_target == nullptr || !r.label_target->fits(view.width, view.height)) {
    r.label_target = std::make_unique<Target>(gl, GL_R32UI, view.width, view.height);
  }
  r.label_target->use();
  const std::array<GLuint, 4> nothing{};
  gl.ClearBufferuiv(GL_COLOR, 0, nothing.data());
  gl.Clear(GL_DEPTH_BUFFER_BIT);
  r.label->use();
  const Mat4 clip = world_to_clip(view);
  const std::vector<double> sizes = r.meshes.sizes_seen(list, shown);
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const DrawItem& item = list.items[i];
    const Mat4 mesh_to_clip = clip * matrix(item.X_WG, item.scale);
    r.label->set("to_clip", mesh_to_clip);
    r.label->set("id", item.id);
    r.meshes.draw(r.meshes.seen(item, sizes[i]), mesh_to_clip);
  }

  const auto width = static_cast<std::size_t>(view.width);
  const auto height = static_cast<std::size_t>(view.height);
  Labels labels{view.width, view.height, std::vector<std::uint32_t>(width * height),
                std::vector<float>(width * height)};
  gl.ReadPixels(0, 0, view.width, view.height, GL_RED_INTEGER, GL_UNSIGNED_INT, labels.id.data());
  gl.ReadPixels(0, 0, view.width, view.height, GL_DEPTH_COMPONENT, GL_FLOAT, labels.depth.data());
  r.finish("Renderer::labels");
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
