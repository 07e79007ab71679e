#include "app/draw/picture_window.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>

#include <vtkImageData.h>
#include <vtkPNGWriter.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkRendererCollection.h>
#include <vtkUnsignedCharArray.h>

#include "app/draw/vtk_errors.h"

namespace hvp::draw {
namespace {

constexpr int kChannels = 3;

// The mean of each block of kSupersampling² pixels.
vtkSmartPointer<vtkImageData> averaged(const vtkUnsignedCharArray& rendered) {
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(kPictureWidth, kPictureHeight, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, kChannels);
  auto* out = static_cast<unsigned char*>(image->GetScalarPointer());
  constexpr std::ptrdiff_t kRow = std::ptrdiff_t{kChannels} * kSupersampling * kPictureWidth;
  const unsigned char* in = const_cast<vtkUnsignedCharArray&>(rendered).GetPointer(0);
  for (int y = 0; y < kPictureHeight; ++y)
    for (int x = 0; x < kPictureWidth; ++x)
      for (int channel = 0; channel < kChannels; ++channel) {
        int sum = kSupersampling * kSupersampling / 2;
        for (int j = 0; j < kSupersampling; ++j)
          for (int i = 0; i < kSupersampling; ++i)
            sum += in[(y * kSupersampling + j) * kRow + (x * kSupersampling + i) * kChannels +
                      channel];
        *out++ = static_cast<unsigned char>(sum / (kSupersampling * kSupersampling));
      }
  return image;
}

}  // namespace

PictureWindow::PictureWindow() {
  window_->SetOffScreenRendering(1);
  window_->SetMultiSamples(0);
  window_->SetAlphaBitPlanes(1);
  window_->SetSize(kPictureWidth * kSupersampling, kPictureHeight * kSupersampling);
}

PictureWindow::~PictureWindow() = default;

void PictureWindow::add(vtkRenderer& renderer, int layer) {
  window_->SetNumberOfLayers(std::max(window_->GetNumberOfLayers(), layer + 1));
  renderer.SetLayer(layer);
  window_->AddRenderer(&renderer);
}

std::string PictureWindow::take_png() {
  VtkErrors::take();
  window_->Render();
  vtkNew<vtkUnsignedCharArray> pixels;
  window_->GetPixelData(0, 0, kSupersampling * kPictureWidth - 1,
                        kSupersampling * kPictureHeight - 1, 1, pixels);
  const vtkIdType values = pixels->GetNumberOfValues();
  if (VtkErrors::take() ||
      values !=
          vtkIdType{kChannels} * kSupersampling * kPictureWidth * kSupersampling * kPictureHeight ||
      std::all_of(pixels->GetPointer(0), pixels->GetPointer(values),
                  [&](unsigned char v) { return v == *pixels->GetPointer(0); }))
    throw std::runtime_error("OpenGL on this display rendered nothing");
  while (vtkRenderer* renderer = window_->GetRenderers()->GetFirstRenderer())
    window_->RemoveRenderer(renderer);

  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(averaged(*pixels));
  writer->WriteToMemoryOn();
  writer->Write();
  const vtkUnsignedCharArray& png = *writer->GetResult();
  auto& bytes = const_cast<vtkUnsignedCharArray&>(png);
  return {reinterpret_cast<const char*>(bytes.GetPointer(0)),
          static_cast<std::size_t>(bytes.GetNumberOfValues())};
}

}  // namespace hvp::draw
