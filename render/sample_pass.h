#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "render/eye_scene.h"
#include "render/finer_part.h"
#include "render/gl_objects.h"
#include "render/meshes.h"

namespace headpin::render {

/// Draws a view, or a part of it, into a grid of samples and averages these to a picture.
class SamplePass {
 public:
  /// Draws all that is in a scene into the bound target.
  using DrawAll = std::function<void(const EyeScene&)>;

  /// @param gl, meshes  must outlive this
  /// @param samples     SampleGrid::n
  SamplePass(const Gl& gl, const Meshes& meshes, int samples, DrawAll draw_all)
      : gl_(gl), meshes_(meshes), grid_{samples}, draw_all_(std::move(draw_all)) {}

  /// The largest width and height of a view.
  int most_pixels() const;

  /// Draws a view; the scene has its place and its projection already.
  ///
  /// @param number  of the view
  void draw(const EyeScene& scene, const View& view, std::size_t number);
  /// The picture of a view that was drawn. Its small bodies are drawn again with more samples.
  Image read(const EyeScene& scene, const View& view, std::size_t number);

 private:
  void lay_grid(EyeScene& scene, const View& whole, const PixelRect& part,
                const SampleGrid& laid) const;
  void draw_part(EyeScene scene, const View& whole, const PixelRect& part, const SampleGrid& laid,
                 std::unique_ptr<Target>& target) const;
  Image read_part(const Target& target, const PixelRect& part, const SampleGrid& laid);
  std::optional<PixelRect> small_part(const EyeScene& scene, const View& view) const;

  const Gl& gl_;
  const Meshes& meshes_;
  SampleGrid grid_;
  DrawAll draw_all_;
  std::vector<std::unique_ptr<Target>> targets_;  ///< of the last views' sizes, in samples
  std::unique_ptr<Target> finer_target_;          ///< of the last part that was drawn again
  std::vector<std::uint8_t> samples_;
};

}  // namespace headpin::render
