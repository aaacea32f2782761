#pragma once

#include <array>
#include <stdexcept>
#include <string>

#include "render/gl_functions.h"
#include "render/matrices.h"

/// OpenGL objects with the lifetime of C++ objects: programs, render targets, shadow maps.
namespace headpin::render {

/// A compiled shader program; its uniforms are set by name.
class Program {
 public:
  Program(const Gl& gl, const std::string& vertex, const std::string& fragment) : gl_(&gl) {
    name_ = gl.CreateProgram();
    attach(GL_VERTEX_SHADER, vertex.c_str());
    attach(GL_FRAGMENT_SHADER, fragment.c_str());
    gl.LinkProgram(name_);
    GLint ok = 0;
    gl.GetProgramiv(name_, GL_LINK_STATUS, &ok);
    if (ok == 0) {
      std::array<char, 1024> log{};
      gl.GetProgramInfoLog(name_, static_cast<GLsizei>(log.size()), nullptr, log.data());
      throw std::runtime_error(std::string("shader does not link: ") + log.data());
    }
  }
  ~Program() { gl_->DeleteProgram(name_); }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  void use() const { gl_->UseProgram(name_); }
  void set(const char* uniform, const Mat4& m) const {
    const Eigen::Matrix4f f = m.cast<float>();
    gl_->UniformMatrix4fv(at(uniform), 1, GL_FALSE, f.data());
  }
  void set(const char* uniform, const Vec3& v) const {
    const Eigen::Vector3f f = v.cast<float>();
    gl_->Uniform3f(at(uniform), f.x(), f.y(), f.z());
  }
  void set(const char* uniform, double x) const {
    gl_->Uniform1f(at(uniform), static_cast<float>(x));
  }
  void set(const char* uniform, int x) const { gl_->Uniform1i(at(uniform), x); }
  void set(const char* uniform, std::uint32_t x) const { gl_->Uniform1ui(at(uniform), x); }

 private:
  void attach(GLenum kind, const char* source) const {
    const GLuint shader = gl_->CreateShader(kind);
    gl_->ShaderSource(shader, 1, &source, nullptr);
    gl_->CompileShader(shader);
    GLint ok = 0;
    gl_->GetShaderiv(shader, GL_COMPILE_STATUS, &ok);
    if (ok == 0) {
      std::array<char, 1024> log{};
      gl_->GetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
      throw std::runtime_error(std::string("shader does not compile: ") + log.data());
    }
    gl_->AttachShader(name_, shader);
    gl_->DeleteShader(shader);
  }
  GLint at(const char* uniform) const { return gl_->GetUniformLocation(name_, uniform); }

  const Gl* gl_;
  GLuint name_ = 0;
};

/// A render target with colour and depth.
class Target {
 public:
  Target(const Gl& gl, GLenum format, int width, int height)
      : gl_(&gl), width_(width), height_(height) {
    gl.GenFramebuffers(1, &buffer_);
    gl.BindFramebuffer(GL_FRAMEBUFFER, buffer_);
    gl.GenRenderbuffers(2, parts_.data());
    attach(parts_[0], format, GL_COLOR_ATTACHMENT0);
    attach(parts_[1], GL_DEPTH_COMPONENT24, GL_DEPTH_ATTACHMENT);
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      throw std::runtime_error("OpenGL cannot draw into " + std::to_string(width) + "x" +
                               std::to_string(height) + " pixels");
    }
  }
  ~Target() {
    gl_->DeleteFramebuffers(1, &buffer_);
    gl_->DeleteRenderbuffers(2, parts_.data());
  }
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  bool fits(int width, int height) const { return width == width_ && height == height_; }
  void use() const {
    gl_->BindFramebuffer(GL_FRAMEBUFFER, buffer_);
    gl_->Viewport(0, 0, width_, height_);
  }

 private:
  void attach(GLuint part, GLenum format, GLenum where) const {
    gl_->BindRenderbuffer(GL_RENDERBUFFER, part);
    gl_->RenderbufferStorage(GL_RENDERBUFFER, format, width_, height_);
    gl_->FramebufferRenderbuffer(GL_FRAMEBUFFER, where, GL_RENDERBUFFER, part);
  }

  const Gl* gl_;
  int width_, height_;
  GLuint buffer_ = 0;
  std::array<GLuint, 2> parts_{};
};

/// Sets the bound texture to linear filtering, with its edge repeated outside.
inline void read_between_texels(const Gl& gl) {
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

/// The image that polished floors reflect, in linear light. One sample per pixel is enough, because
/// it is interpolated.
class MirrorImage {
 public:
  MirrorImage(const Gl& gl, int width, int height) : gl_(&gl), width_(width), height_(height) {
    gl.GenTextures(1, &texture_);
    gl.ActiveTexture(GL_TEXTURE0 + kUnit);
    gl.BindTexture(GL_TEXTURE_2D, texture_);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
    read_between_texels(gl);
    gl.ActiveTexture(GL_TEXTURE0);
    gl.GenRenderbuffers(1, &depth_);
    gl.BindRenderbuffer(GL_RENDERBUFFER, depth_);
    gl.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT24, width, height);
    gl.GenFramebuffers(1, &buffer_);
    gl.BindFramebuffer(GL_FRAMEBUFFER, buffer_);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture_, 0);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      throw std::runtime_error("OpenGL cannot draw a mirror image of " + std::to_string(width) +
                               "x" + std::to_string(height) + " pixels");
    }
  }
  ~MirrorImage() {
    gl_->DeleteFramebuffers(1, &buffer_);
    gl_->DeleteRenderbuffers(1, &depth_);
    gl_->DeleteTextures(1, &texture_);
  }
  MirrorImage(const MirrorImage&) = delete;
  MirrorImage& operator=(const MirrorImage&) = delete;

  bool fits(int width, int height) const { return width == width_ && height == height_; }
  void use() const {
    gl_->BindFramebuffer(GL_FRAMEBUFFER, buffer_);
    gl_->Viewport(0, 0, width_, height_);
  }
  /// To be read by programs.
  void bind() const {
    gl_->ActiveTexture(GL_TEXTURE0 + kUnit);
    gl_->BindTexture(GL_TEXTURE_2D, texture_);
    gl_->ActiveTexture(GL_TEXTURE0);
  }

  static constexpr int kUnit = 1;

 private:
  const Gl* gl_;
  int width_, height_;
  GLuint texture_ = 0, depth_ = 0, buffer_ = 0;
};

/// A shadow map; reading it compares and filters depths. Outside of it everything is lit.
class ShadowMap {
 public:
  ShadowMap(const Gl& gl, int width, int height) : gl_(&gl), width_(width), height_(height) {
    gl.GenTextures(1, &texture_);
    gl.BindTexture(GL_TEXTURE_2D, texture_);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, width, height, 0, GL_DEPTH_COMPONENT,
                  GL_UNSIGNED_INT, nullptr);
    read_between_texels(gl);
    const std::array<GLfloat, 4> farthest{1.0F, 1.0F, 1.0F, 1.0F};
    gl.TexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, farthest.data());
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    gl.GenFramebuffers(1, &buffer_);
    gl.BindFramebuffer(GL_FRAMEBUFFER, buffer_);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_, 0);
    gl.DrawBuffer(GL_NONE);
    gl.ReadBuffer(GL_NONE);
  }
  ~ShadowMap() {
    gl_->DeleteFramebuffers(1, &buffer_);
    gl_->DeleteTextures(1, &texture_);
  }
  ShadowMap(const ShadowMap&) = delete;
  ShadowMap& operator=(const ShadowMap&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }
  bool fits(int width, int height) const { return width == width_ && height == height_; }
  void use() const {
    gl_->BindFramebuffer(GL_FRAMEBUFFER, buffer_);
    gl_->Viewport(0, 0, width_, height_);
  }

 private:
  const Gl* gl_;
  int width_, height_;
  GLuint texture_ = 0, buffer_ = 0;
};

}  // namespace headpin::render
