#include "headless_gl.h"

#include <EGL/eglext.h>

#include <sstream>

#include "perennial/core/error.h"

namespace perennial::park {
namespace {

[[noreturn]] void fail(const char* what) {
  std::ostringstream message;
  message << "the park cannot be rendered: " << what << " failed (EGL error 0x" << std::hex << eglGetError()
          << "); install libegl1, libegl-mesa0 and libgl1-mesa-dri";
  throw Error(message.str());
}

EGLDisplay openDisplay() {
  const auto get =
      reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(eglGetProcAddress("eglGetPlatformDisplayEXT"));
  EGLDisplay display =
      get == nullptr ? EGL_NO_DISPLAY : get(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) != EGL_TRUE) {
    fail("eglInitialize");
  }
  return display;
}

EGLConfig chooseConfig(EGLDisplay display) {
  const EGLint wanted[] = {EGL_SURFACE_TYPE,
                           EGL_PBUFFER_BIT,
                           EGL_RENDERABLE_TYPE,
                           EGL_OPENGL_BIT,
                           EGL_RED_SIZE,
                           8,
                           EGL_GREEN_SIZE,
                           8,
                           EGL_BLUE_SIZE,
                           8,
                           EGL_ALPHA_SIZE,
                           8,
                           EGL_DEPTH_SIZE,
                           24,
                           EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (eglChooseConfig(display, wanted, &config, 1, &count) != EGL_TRUE || count == 0) {
    fail("eglChooseConfig");
  }
  return config;
}

}  // namespace

HeadlessGl::HeadlessGl(int width, int height) : display_(openDisplay()) {
  const EGLConfig config = chooseConfig(display_);
  const EGLint size[] = {EGL_WIDTH, width, EGL_HEIGHT, height, EGL_NONE};
  surface_ = eglCreatePbufferSurface(display_, config, size);
  if (surface_ == EGL_NO_SURFACE || eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) {
    fail("eglCreatePbufferSurface");
  }
  context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, nullptr);
  if (context_ == EGL_NO_CONTEXT) {
    fail("eglCreateContext");
  }
}

// The display is shared by all contexts of the process: it is not terminated here.
HeadlessGl::~HeadlessGl() {
  eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
  eglDestroySurface(display_, surface_);
}

void HeadlessGl::makeCurrent() {
  if (eglGetCurrentContext() != context_ &&
      eglMakeCurrent(display_, surface_, surface_, context_) != EGL_TRUE) {
    fail("eglMakeCurrent");
  }
}

}  // namespace perennial::park
