#pragma once

#include <string>

#include "app/draw/run_files.h"

namespace hvp::draw {

class Canvas;

// The head of a picture: what it shows of which run, what it is about in figures, and what the run
// came to with its flags. What is too long for the picture is cut.
void draw_caption(Canvas& canvas, const Caption& caption, const std::string& what,
                  const std::string& figures);

}  // namespace hvp::draw
