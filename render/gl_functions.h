#pragma once

// Types only: decltype below names the prototypes, nothing links against a GL library. So no libGL
// of another package can replace the one that draws. Loader libraries (GLEW, libepoxy) load libGL
// themselves. (GL_GLEXT_PROTOTYPES is defined for this folder in its CMakeLists.txt.)
#include <GL/gl.h>
#include <GL/glext.h>

// clang-format off
/// The OpenGL 3.3 core functions that are used, one X each.
#define HEADPIN_GL_FUNCTIONS(X)                                                                    \
  X(ActiveTexture) X(AttachShader) X(BindBuffer) X(BindFramebuffer) X(BindRenderbuffer)            \
  X(BindTexture)                                                                                   \
  X(BindVertexArray) X(BlendFunc) X(BufferData) X(CheckFramebufferStatus) X(Clear)                 \
  X(ClearBufferuiv) X(ClearColor) X(CompileShader) X(CreateProgram) X(CreateShader)                \
  X(CullFace) X(DeleteBuffers) X(DeleteFramebuffers) X(DeleteProgram)                              \
  X(DeleteRenderbuffers) X(DeleteShader) X(DeleteTextures) X(DeleteVertexArrays)                   \
  X(DepthFunc) X(DepthMask) X(Disable) X(DrawArrays) X(DrawBuffer) X(DrawElements)                 \
  X(Enable) X(EnableVertexAttribArray) X(Finish) X(FramebufferRenderbuffer)                        \
  X(FramebufferTexture2D) X(FrontFace) X(GenBuffers) X(GenFramebuffers) X(GenRenderbuffers)        \
  X(GenTextures) X(GenVertexArrays) X(GetError) X(GetIntegerv) X(GetProgramInfoLog)                \
  X(GetProgramiv) X(GetShaderInfoLog) X(GetShaderiv) X(GetString) X(GetUniformLocation)            \
  X(LinkProgram) X(PixelStorei) X(PolygonOffset) X(ReadBuffer) X(ReadPixels)                       \
  X(RenderbufferStorage) X(ShaderSource) X(TexImage2D) X(TexParameterfv) X(TexParameteri)          \
  X(Uniform1f) X(Uniform1i) X(Uniform1ui) X(Uniform3f) X(UniformMatrix4fv)               \
  X(UseProgram) X(VertexAttribPointer) X(Viewport)
// clang-format on

namespace headpin::render {

/// The functions of one context: gl.Clear(...) is glClear(...). Only for .cpp files of this folder.
struct Gl {
// NOLINTNEXTLINE(bugprone-macro-parentheses): a member's name
#define HEADPIN_GL_MEMBER(name) decltype(&::gl##name) name = nullptr;
  HEADPIN_GL_FUNCTIONS(HEADPIN_GL_MEMBER)
#undef HEADPIN_GL_MEMBER
};

}  // namespace headpin::render
