#include <algorithm>
#include <stdexcept>
#include <string>

#include "render/renderer_impl.h"

// Draws a view, or a part of it, into a grid of samples and averages these to a picture.
namespace headpin::render {

void Renderer::Impl::check(const DrawList& list, const View& view) const {
  for (const DrawItem& item : list.items) {
    for (const int mesh : {item.mesh, item.far_mesh.value_or(item.mesh), faint_mesh(item)}) {
      if (mesh >= 0 && static_cast<std::size_t>(mesh) < meshes.size()) continue;
      throw std::invalid_argument("draw list: mesh " + std::to_string(mesh) + " of " +
                                  std::to_string(meshes.size()));
    }
  }
  if (list.lamps.size() > DrawList::kLamps) {
    throw std::invalid_argument("draw list: " + std::to_string(list.lamps.size()) +
                                " lamps, at most " + std::to_string(DrawList::kLamps));
  }
  const int most = largest / (quality.samples + grid.turn()) - 1;
  if (view.width < 1 || view.height < 1 || view.width > most || view.height > most) {
    throw std::invalid_argument("view: " + std::to_string(view.width) + "x" +
                                std::to_string(view.height) + " pixels, expected 1 to " +
                                std::to_string(most));
  }
}

void Renderer::Impl::lay_grid(Scene& scene, const View& whole, const Part& part,
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
  cut_picture(laid.turn() == 1);
}

void Renderer::Impl::draw_part(Scene scene, const View& whole, const Part& part,
                               const SampleGrid& laid, GLsizei contacts,
                               std::unique_ptr<Target>& target) const {
  const int width = laid.width(part.width, part.height);
  const int height = laid.height(part.width, part.height);
  if (!target || !target->fits(width, height)) {
    target = std::make_unique<Target>(gl, GL_RGBA8, width, height);
  }
  target->use();
  clear(srgb_of(scene.list->background));
  scene.world_to_clip = world_to_clip(view_of(whole, part));
  lay_grid(scene, whole, part, laid);
  for (const Surface surface : kTurns) draw_surface(scene, surface, contacts);
}

Image Renderer::Impl::read(const Target& target, const Part& part, const SampleGrid& laid) {
  target.use();
  const int width = laid.width(part.width, part.height);
  const int height = laid.height(part.width, part.height);
  samples.resize(std::size_t{4} * static_cast<std::size_t>(width) *
                 static_cast<std::size_t>(height));
  gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, samples.data());
  return average(samples, part.width, part.height, laid.n);
}

std::optional<Part> Renderer::Impl::small_part(const Scene& scene, const View& view) const {
  Eigen::AlignedBox2d all;
  for (std::size_t i = 0; i < scene.list->items.size(); ++i) {
    const DrawItem& item = scene.list->items[i];
    if (!item.casts_shadow || scene.sizes[i] >= kSmall) continue;
    const auto pixels =
        pixels_of(kept(item.mesh).box, scene.world_to_clip * matrix(item.X_WG, item.scale), view);
    if (pixels) all.extend(*pixels);
  }
  return part_of(view, all);
}

void Renderer::Impl::refine(const Scene& scene, const View& view, GLsizei contacts, Image& image) {
  if (quality.samples == 1) return;
  const std::optional<Part> part = small_part(scene, view);
  if (!part) return;
  const std::optional<SampleGrid> finer = finer_grid(grid, view, *part);
  if (!finer) return;
  draw_part(scene, view, *part, *finer, contacts, finer_target);
  paste(read(*finer_target, *part, *finer), *part, image);
}

}  // namespace headpin::render
