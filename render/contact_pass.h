#pragma once

#include "render/eye_scene.h"
#include "render/gl_objects.h"

namespace headpin::render {

/// Darkens floors beneath and beside bodies (render/contact_shadow.h).
class ContactPass {
 public:
  /// @param gl  must outlive this
  ContactPass(const Gl& gl, bool on);
  ~ContactPass();
  ContactPass(const ContactPass&) = delete;
  ContactPass& operator=(const ContactPass&) = delete;

  /// Takes the patches and occluders of a list.
  void load(const DrawList& list);
  /// Draws over what is drawn of the floors.
  void draw(const EyeScene& scene) const;

 private:
  const Gl& gl_;
  bool on_;
  Program program_;
  GLuint arrays_ = 0, buffer_ = 0;
  GLsizei count_ = 0;  ///< vertices of the loaded list
};

}  // namespace headpin::render
