#include "app/draw/vtk_errors.h"

#include <utility>

#include <vtkLogger.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkOutputWindow.h>

namespace hvp::draw {
namespace {

bool error_seen = false;

class ErrorNote : public vtkOutputWindow {
 public:
  static ErrorNote* New();
  void DisplayText(const char* /*text*/) override {}
  void DisplayErrorText(const char* /*text*/) override { error_seen = true; }
  void DisplayWarningText(const char* /*text*/) override {}
  void DisplayGenericWarningText(const char* /*text*/) override {}
  void DisplayDebugText(const char* /*text*/) override {}
};
vtkStandardNewMacro(ErrorNote)

}  // namespace

void VtkErrors::capture() {
  vtkNew<ErrorNote> note;
  vtkOutputWindow::SetInstance(note);
  // Errors pass the window and then the log, which writes to stderr by itself.
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
}

bool VtkErrors::take() { return std::exchange(error_seen, false); }

}  // namespace hvp::draw
