#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "render/contact_pass.h"
#include "render/eye_scene.h"
#include "render/finer_part.h"
#include "render/gl_objects.h"
#include "render/mesh_pass.h"
#include "render/meshes.h"

namespace headpin::render {

/// Draws a view, or a part of it, into a grid of samples and averages these to a picture.
class SamplePass {
 public:
  /// @param gl, meshes, surfaces, contact  must outlive this
  /// @param samples                        SampleGrid::n
  SamplePass(const Gl& gl, const Meshes& meshes, const MeshPass& surfaces,
             const ContactPass& contact, int samples)
      : gl_(gl), meshes_(meshes), surfaces_(surfaces), contact_(contact), grid_{samples} {}

  /// The largest width and height of a view [pixels].
  int most_pixels() const;
  /// How many samples it takes of each pixel.
  int a_pixel() const { return grid_.a_pixel(); }

  /// Draws a view; the scene has its place and its projection already.
  ///
  /// @param number  of the view
  void draw(const EyeScene& scene, const View& view, std::size_t number);
  /// The picture of a view that was drawn. Its small bodies are drawn again with more samples.
  Image read(const EyeScene& scene, const View& view, std::size_t number);

 private:
  int largest_side() const;
  void draw_all(const EyeScene& scene) const;
  void lay_grid(EyeScene& scene, const View& whole, const PixelRect& part,
                const SampleGrid& laid) const;
  void draw_part(EyeScene scene, const View& whole, const PixelRect& part, const SampleGrid& laid,
                 std::unique_ptr<Target>& target) const;
  Image read_part(const Target& target, const PixelRect& part, const SampleGrid& laid);
  std::optional<PixelRect> small_part(const EyeScene& scene, const View& view) const;

  const Gl& gl_;
  const Meshes& meshes_;
  const MeshPass& surfaces_;
  const ContactPass& contact_;
  SampleGrid grid_;
  std::vector<std::unique_ptr<Target>> targets_;  ///< of the last views' sizes, in samples
  std::unique_ptr<Target> finer_target_;          ///< of the last part that was drawn again
  std::vector<std::uint8_t> samples_;
};

}  // namespace headpin::render
