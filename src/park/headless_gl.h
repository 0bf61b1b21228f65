#pragma once

#include <EGL/egl.h>

namespace perennial::park {

/// An OpenGL context without a screen or an X server (EGL, surfaceless platform of Mesa, off-screen pbuffer).
class HeadlessGl {
 public:
  /// Throws Error, with what to install, when there is no such OpenGL here.
  HeadlessGl(int width, int height);
  ~HeadlessGl();
  HeadlessGl(const HeadlessGl&) = delete;
  HeadlessGl& operator=(const HeadlessGl&) = delete;

  /// Makes this context the calling thread's current one. Throws Error.
  void makeCurrent();

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLSurface surface_ = EGL_NO_SURFACE;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace perennial::park
