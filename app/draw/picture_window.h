#pragma once

#include <string>

#include <vtkNew.h>

class vtkRenderer;
class vtkRenderWindow;

namespace hvp::draw {

// Size of the pictures in pixels. They are rendered larger by kSupersampling in each direction and
// averaged down, which smooths edges on every OpenGL, multisampling or not.
inline constexpr int kPictureWidth = 1400;
inline constexpr int kPictureHeight = 1000;
inline constexpr int kSupersampling = 2;

// An off-screen window in which the pictures are drawn one after the other: creating the OpenGL
// context is the slow part. It needs an X display; VTK aborts the process without one.
class PictureWindow {
 public:
  PictureWindow();
  ~PictureWindow();
  PictureWindow(const PictureWindow&) = delete;
  PictureWindow& operator=(const PictureWindow&) = delete;

  // Adds a renderer in a layer; layer 0 is at the bottom.
  void add(vtkRenderer& renderer, int layer);
  // Renders the layers, removes them from the window and returns the picture as PNG.
  // Throws std::runtime_error when nothing but the background came out.
  std::string take_png();

 private:
  vtkNew<vtkRenderWindow> window_;
};

}  // namespace hvp::draw
