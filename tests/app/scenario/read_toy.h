#pragma once

#include <string>
#include <vector>

#include "app/scenario/document.h"
#include "app/scenario/reader.h"
#include "tests/app/scenario/toy_scene.h"

namespace hvp::scenario::toy {

inline Scene read_scene(const std::string& text, const std::vector<std::string>& overrides = {}) {
  Scene scene;
  read(Document::parse(text, "x.toml", overrides), scene);
  return scene;
}

// The complete line of the error that reading the text gives, or "no error".
inline std::string error_of(const std::string& text,
                            const std::vector<std::string>& overrides = {}) {
  try {
    read_scene(text, overrides);
  } catch (const SourceError& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace hvp::scenario::toy
