#include "render/shadow_pass.h"

#include <algorithm>
#include <cmath>

#include "render/shaders.h"

namespace headpin::render {

namespace {

/// Texels of a shadow map for a length that it covers.
int texels(double length) {
  constexpr double kTexel = 0.008;  // [m]; coarser where that would be more than kMost
  constexpr double kMost = 2048.0;
  return static_cast<int>(std::ceil(std::clamp(length / kTexel, 1.0, kMost)));
}

}  // namespace

ShadowPass::ShadowPass(const Gl& gl, bool on)
    : gl_(gl), on_(on), depth_(gl, shaders::kDepthVertex, shaders::kDepthFragment) {}

CastShadow ShadowPass::draw(const DrawList& list, const Meshes& meshes) {
  const LightView light = light_view(list.shadow);
  CastShadow shadow;
  shadow.view =  // to 0..1, as textures need it
      matrix({Quat::Identity(), Vec3::Constant(0.5)}, Vec3::Constant(0.5)) * light.to_clip;
  if (!on_) return shadow;
  const int width = texels(light.size.x()), height = texels(light.size.y());
  if (!map_ || !map_->fits(width, height)) map_ = std::make_unique<ShadowMap>(gl_, width, height);
  if (list.shadow.depth <= 0.0) return shadow;
  draw_depth(list, meshes, light.to_clip);
  shadow.shades = shades_of(list, meshes, shadow.view);
  return shadow;
}

void ShadowPass::draw_depth(const DrawList& list, const Meshes& meshes, const Mat4& view) const {
  map_->use();
  gl_.Clear(GL_DEPTH_BUFFER_BIT);
  gl_.CullFace(GL_FRONT);
  depth_.use();
  for (const DrawItem& item : list.items) {
    if (!item.casts_shadow) continue;
    const Mat4 mesh_to_clip = view * matrix(item.X_WG, item.scale);
    depth_.set("to_clip", mesh_to_clip);
    meshes.draw(meshes[faint_mesh(item)], mesh_to_clip);
  }
  gl_.CullFace(GL_BACK);
}

/// With a margin for the soft edge.
std::vector<Eigen::AlignedBox2d> ShadowPass::shades_of(const DrawList& list, const Meshes& meshes,
                                                       const Mat4& shadow_view) const {
  std::vector<Eigen::AlignedBox2d> shades;
  const Vec2 wide(2.0 / map_->width(), 2.0 / map_->height());
  for (const DrawItem& item : list.items) {
    if (!item.casts_shadow) continue;
    const Eigen::AlignedBox2d box =
        across(meshes[faint_mesh(item)].box, shadow_view * matrix(item.X_WG, item.scale));
    shades.emplace_back(box.min() - wide, box.max() + wide);
  }
  return shades;
}

}  // namespace headpin::render
