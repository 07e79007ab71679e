#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <sys/types.h>

#include "app/serve/file_descriptor.h"

namespace hvp::serve {

// A Unix socket at a path that only its user may connect to (mode 0600). It takes the place of one
// that a program has left behind, and is removed at the end.
class ListeningSocket {
 public:
  // Throws InputError where something else is there, where somebody listens there, and where the
  // system allows none (no such folder, a path that is too long).
  explicit ListeningSocket(const std::filesystem::path& path);
  ~ListeningSocket();
  ListeningSocket(const ListeningSocket&) = delete;
  ListeningSocket& operator=(const ListeningSocket&) = delete;

  int number() const { return socket_.number(); }
  // Who waits to be let in, if anybody does.
  std::optional<FileDescriptor> accept();

 private:
  std::filesystem::path path_;
  FileDescriptor socket_;
  // Of the socket's file, so that another one that took its place is left alone.
  dev_t device_ = 0;
  ino_t inode_ = 0;
};

}  // namespace hvp::serve
