#include "render/sample_pass.h"

#include <array>

namespace headpin::render {

namespace {

/// The surfaces in the order of drawing.
constexpr std::array kTurns = {Surface::lit, Surface::floor, Surface::baked};

}  // namespace

/// The largest width and height of what OpenGL draws into [samples].
int SamplePass::largest_side() const {
  GLint largest = 0;
  gl_.GetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  return largest;
}

int SamplePass::most_pixels() const {
  return largest_side() / (grid_.n + grid_.turn()) - 1;
}

void SamplePass::draw(const EyeScene& scene, const View& view, std::size_t number) {
  if (targets_.size() <= number) targets_.resize(number + 1);
  draw_part(scene, view, whole(view), grid_, targets_[number]);
}

Image SamplePass::read(const EyeScene& scene, const View& view, std::size_t number) {
  Image image = read_part(*targets_[number], whole(view), grid_);
  if (grid_.n == 1) return image;
  const std::optional<PixelRect> part = small_part(scene, view);
  if (!part) return image;
  const std::optional<SampleGrid> finer = finer_grid(grid_, view, *part, largest_side());
  if (!finer) return image;
  draw_part(scene, view, *part, *finer, finer_target_);
  paste(read_part(*finer_target_, *part, *finer), *part, image);
  return image;
}

/// All surfaces of a scene, with the contact shadows on the floor.
void SamplePass::draw_all(const EyeScene& scene) const {
  for (const Surface surface : kTurns) {
    surfaces_.draw(scene, surface);
    if (surface == Surface::floor) contact_.draw(scene);
  }
}

/// Rotates the picture into the grid of its samples; samples outside of it are not drawn.
///
/// @param part  part of the view for which the reflection was drawn
void SamplePass::lay_grid(EyeScene& scene, const View& whole, const PixelRect& part,
                          const SampleGrid& laid) const {
  const double n = laid.n, w = part.width, h = part.height;
  const int across = laid.width(part.width, part.height);
  const int up = laid.height(part.width, part.height);
  scene.grid_x = Vec3(n * w, -laid.turn() * h, 0.0) / across;
  scene.grid_y = Vec3(laid.turn() * w, n * h, 0.0) / up;
  scene.edge = Vec3(1.0 + 1.0 / w, 1.0 + 1.0 / h, 0.0);
  Eigen::Matrix2d turned;
  turned << scene.grid_x.x(), scene.grid_x.y(), scene.grid_y.x(), scene.grid_y.y();
  const Eigen::Matrix2d back = turned.inverse();
  const auto place = [&](int k, double from, double size, double whole_size) {
    const Vec3 in_part(back(k, 0) / across, back(k, 1) / up, 0.5 - 0.5 * back.row(k).sum());
    return Vec3((size * in_part + from * Vec3::UnitZ()) / whole_size);
  };
  scene.picture_u = place(0, part.x, w, whole.width);
  scene.picture_v = place(1, part.y, h, whole.height);
  cut_picture(gl_, laid.turn() == 1);
}

void SamplePass::draw_part(EyeScene scene, const View& whole, const PixelRect& part,
                           const SampleGrid& laid, std::unique_ptr<Target>& target) const {
  const int width = laid.width(part.width, part.height);
  const int height = laid.height(part.width, part.height);
  if (!target || !target->fits(width, height)) {
    target = std::make_unique<Target>(gl_, GL_RGBA8, width, height);
  }
  target->use();
  clear(gl_, srgb_of(scene.list->background));
  scene.world_to_clip = world_to_clip(view_of(whole, part));
  lay_grid(scene, whole, part, laid);
  draw_all(scene);
}

Image SamplePass::read_part(const Target& target, const PixelRect& part, const SampleGrid& laid) {
  target.use();
  const int width = laid.width(part.width, part.height);
  const int height = laid.height(part.width, part.height);
  samples_.resize(std::size_t{4} * static_cast<std::size_t>(width) *
                  static_cast<std::size_t>(height));
  gl_.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, samples_.data());
  return average(samples_, part.width, part.height, laid.n);
}

/// The part of a view with small bodies, which are those that cast shadows.
std::optional<PixelRect> SamplePass::small_part(const EyeScene& scene, const View& view) const {
  Eigen::AlignedBox2d all;
  for (std::size_t i = 0; i < scene.list->items.size(); ++i) {
    const DrawItem& item = scene.list->items[i];
    if (!item.casts_shadow || (*scene.sizes)[i] >= kSmall) continue;
    const auto pixels = pixels_of(meshes_[item.mesh].box,
                                  scene.world_to_clip * matrix(item.X_WG, item.scale), view);
    if (pixels) all.extend(*pixels);
  }
  return part_of(view, all);
}

}  // namespace headpin::render
