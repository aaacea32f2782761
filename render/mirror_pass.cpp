#include "render/mirror_pass.h"

namespace headpin::render {

void MirrorPass::draw(EyeScene scene, const View& view, std::size_t number) {
  if (!on_) return;
  if (images_.size() <= number) images_.resize(number + 1);
  std::unique_ptr<MirrorImage>& image = images_[number];
  if (!image || !image->fits(view.width, view.height)) {
    image = std::make_unique<MirrorImage>(gl_, view.width, view.height);
  }
  image->use();
  cut_picture(gl_, false);
  clear(gl_, scene.list->background);
  const Mat4 mirror = mirrored_at(scene.list->mirror_z);
  scene.eye_W = (mirror * scene.eye_W.homogeneous()).head<3>();
  scene.world_to_clip = scene.world_to_clip * mirror;
  scene.in_mirror = true;
  gl_.FrontFace(GL_CW);
  gl_.Enable(GL_CLIP_DISTANCE0);
  surfaces_.draw(scene, Surface::lit);
  surfaces_.draw(scene, Surface::baked);
  gl_.Disable(GL_CLIP_DISTANCE0);
  gl_.FrontFace(GL_CCW);
  image->bind();
}

void MirrorPass::use(std::size_t number) const {
  if (on_) images_[number]->bind();
}

}  // namespace headpin::render
