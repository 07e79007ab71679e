#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <signal.h>

#include "app/serve/board_port.h"
#include "app/serve/connection.h"
#include "app/serve/file_descriptor.h"
#include "app/serve/session.h"

namespace hvp::serve {

// Serves one client after another and advances the simulation in between. A client that connects
// while another one is served is refused.
class Server {
 public:
  // Keeps references.
  Server(BoardPort& board, ListeningSocket& socket) : board_(board), socket_(socket) {}

  // Returns after a signal (results::interrupted()) or, with `once`, after the first client that
  // agreed on a version has gone. The caller defers interruptions.
  void run(bool once);
  // Ends run() soon: what is under way for the client is finished, and its answer is not sent.
  void stop() { stopped_ = true; }
  bool stopped() const { return stopped_; }

 private:
  struct Client {
    Client(FileDescriptor socket, FunctionPort& function)
        : connection(std::move(socket)), session(function) {}
    Connection connection;
    Session session;
  };

  void wait(const sigset_t& while_waiting);
  void let_in();
  void serve();
  void let_go(const char* why);

  BoardPort& board_;
  ListeningSocket& socket_;
  std::unique_ptr<Client> client_;
  bool stopped_ = false;
  bool served_ = false;   // a client has agreed on a version and gone
  bool knocked_ = false;  // the last wait found a new client
  bool has_spoken_ = false;
};

}  // namespace hvp::serve
