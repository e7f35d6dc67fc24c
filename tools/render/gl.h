// OpenGL 3.3 core through a function table of our own: works with any context that can look names up (OSMesa
// here).
#pragma once

#include <GL/glcorearb.h>

namespace sinew::render {

// clang-format off
#define SINEW_GL_FUNCTIONS(X)                                                                                \
  X(PFNGLACTIVETEXTUREPROC, ActiveTexture)                                                                   \
  X(PFNGLATTACHSHADERPROC, AttachShader) X(PFNGLBINDBUFFERPROC, BindBuffer) X(                               \
      PFNGLBINDFRAMEBUFFERPROC, BindFramebuffer) X(PFNGLBINDRENDERBUFFERPROC, BindRenderbuffer)              \
      X(PFNGLBINDTEXTUREPROC, BindTexture) X(PFNGLBINDVERTEXARRAYPROC, BindVertexArray) X(                   \
          PFNGLBLENDFUNCPROC, BlendFunc) X(PFNGLBLITFRAMEBUFFERPROC,                                         \
                                           BlitFramebuffer) X(PFNGLBUFFERDATAPROC,                           \
                                                              BufferData) X(PFNGLCHECKFRAMEBUFFERSTATUSPROC, \
                                                                            CheckFramebufferStatus)          \
          X(PFNGLCLEARPROC, Clear) X(PFNGLCLEARCOLORPROC, ClearColor) X(PFNGLCOLORMASKPROC, ColorMask) X(    \
              PFNGLCOMPILESHADERPROC, CompileShader) X(PFNGLCREATEPROGRAMPROC,                               \
                                                       CreateProgram) X(PFNGLCREATESHADERPROC, CreateShader) \
              X(PFNGLCULLFACEPROC, CullFace) X(PFNGLDELETESHADERPROC, DeleteShader) X(                       \
                  PFNGLDEPTHFUNCPROC, DepthFunc) X(PFNGLDEPTHMASKPROC,                                       \
                                                   DepthMask) X(PFNGLDISABLEPROC,                            \
                                                                Disable) X(PFNGLDRAWARRAYSPROC, DrawArrays)  \
                  X(PFNGLDRAWELEMENTSPROC, DrawElements) X(PFNGLDRAWBUFFERPROC, DrawBuffer) X(               \
                      PFNGLENABLEPROC, Enable) X(PFNGLENABLEVERTEXATTRIBARRAYPROC, EnableVertexAttribArray)  \
                      X(PFNGLFRAMEBUFFERRENDERBUFFERPROC, FramebufferRenderbuffer) X(                        \
                          PFNGLFRAMEBUFFERTEXTURE2DPROC, FramebufferTexture2D)                               \
                          X(PFNGLGENBUFFERSPROC, GenBuffers) X(PFNGLGENERATEMIPMAPPROC, GenerateMipmap) X(   \
                              PFNGLGENFRAMEBUFFERSPROC,                                                      \
                              GenFramebuffers) X(PFNGLGENRENDERBUFFERSPROC,                                  \
                                                 GenRenderbuffers) X(PFNGLGENTEXTURESPROC, GenTextures)      \
                              X(PFNGLGENVERTEXARRAYSPROC, GenVertexArrays) X(PFNGLGETERRORPROC, GetError) X( \
                                  PFNGLGETPROGRAMINFOLOGPROC, GetProgramInfoLog)                             \
                                  X(PFNGLGETPROGRAMIVPROC, GetProgramiv) X(                                  \
                                      PFNGLGETSHADERINFOLOGPROC, GetShaderInfoLog) X(PFNGLGETSHADERIVPROC,   \
                                                                                     GetShaderiv)            \
                                      X(PFNGLGETUNIFORMLOCATIONPROC, GetUniformLocation) X(                  \
                                          PFNGLLINKPROGRAMPROC, LinkProgram) X(PFNGLPIXELSTOREIPROC,         \
                                                                               PixelStorei)                  \
                                          X(PFNGLPOLYGONOFFSETPROC, PolygonOffset) X(                        \
                                              PFNGLREADBUFFERPROC, ReadBuffer) X(PFNGLREADPIXELSPROC,        \
                                                                                 ReadPixels)                 \
                                              X(PFNGLRENDERBUFFERSTORAGEPROC, RenderbufferStorage) X(        \
                                                  PFNGLRENDERBUFFERSTORAGEMULTISAMPLEPROC,                   \
                                                  RenderbufferStorageMultisample)                            \
                                                  X(PFNGLSHADERSOURCEPROC, ShaderSource) X(                  \
                                                      PFNGLTEXIMAGE2DPROC, TexImage2D)                       \
                                                      X(PFNGLTEXPARAMETERFVPROC, TexParameterfv) X(          \
                                                          PFNGLTEXPARAMETERIPROC,                            \
                                                          TexParameteri) X(PFNGLUNIFORM1FPROC, Uniform1f)    \
                                                          X(PFNGLUNIFORM1IPROC, Uniform1i) X(                \
                                                              PFNGLUNIFORM3FPROC,                            \
                                                              Uniform3f) X(PFNGLUNIFORM2FPROC, Uniform2f)    \
                                                              X(PFNGLUNIFORMMATRIX4FVPROC, UniformMatrix4fv) \
                                                                  X(PFNGLUSEPROGRAMPROC, UseProgram)         \
                                                                      X(PFNGLVERTEXATTRIBPOINTERPROC,        \
                                                                        VertexAttribPointer)                 \
                                                                          X(PFNGLVIEWPORTPROC, Viewport)
// clang-format on

struct Gl {
#define SINEW_GL_MEMBER(type, name) type name = nullptr;
  SINEW_GL_FUNCTIONS(SINEW_GL_MEMBER)
#undef SINEW_GL_MEMBER
};

}  // namespace sinew::render
