#include "app/serve/server.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <poll.h>
#include <spdlog/spdlog.h>

#include "app/results/part_files.h"

namespace hvp::serve {

namespace {

// Signals are unblocked only while the server waits, as a signal just before the wait would not end
// it.
class SignalsOnlyInWaits {
 public:
  SignalsOnlyInWaits() {
    sigset_t ends{};
    sigemptyset(&ends);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&ends, number);
    sigprocmask(SIG_BLOCK, &ends, &before_);
  }
  ~SignalsOnlyInWaits() { sigprocmask(SIG_SETMASK, &before_, nullptr); }
  SignalsOnlyInWaits(const SignalsOnlyInWaits&) = delete;
  SignalsOnlyInWaits& operator=(const SignalsOnlyInWaits&) = delete;

  const sigset_t& before() const { return before_; }

 private:
  sigset_t before_{};
};

}  // namespace

void Server::run(bool once) {
  const SignalsOnlyInWaits signals;
  while (results::interrupted() == 0 && !stopped_ && !(once && served_)) {
    wait(signals.before());
    if (has_spoken_) {
      serve();
    } else if (client_ && board_.has_work()) {
      board_.advance();
    }
    if (knocked_) let_in();
  }
  if (client_) {
    client_->connection.finish();
    let_go("");
  }
}

void Server::wait(const sigset_t& while_waiting) {
  std::array<pollfd, 2> files = {
      {{.fd = socket_.number(), .events = POLLIN, .revents = 0},
       {.fd = client_ ? client_->connection.number() : -1, .events = POLLIN, .revents = 0}}};
  // Without a client nothing waits for the simulation.
  const timespec at_once{};
  const bool simulates = client_ != nullptr && board_.has_work();
  const int ready =
      ::ppoll(files.data(), files.size(), simulates ? &at_once : nullptr, &while_waiting);
  if (ready < 0 && errno != EINTR) {
    throw std::runtime_error(fmt::format("poll: {}", std::strerror(errno)));
  }
  has_spoken_ = ready > 0 && files[1].revents != 0;
  // A new client is not refused for the sake of one that has hung up and is about to be removed.
  knocked_ = ready > 0 && files[0].revents != 0 && (files[1].revents & POLLHUP) == 0;
}

void Server::let_in() {
  std::optional<FileDescriptor> socket = socket_.accept();
  if (!socket) return;
  if (client_) {
    spdlog::warn("a second client was refused: the board serves one at a time");
    Header greeting;
    greeting.command = static_cast<std::uint16_t>(Request::version);
    try {
      Connection(std::move(*socket)).send(error_reply(greeting, EBUSY));
    } catch (const Broken&) {
      // The second client has gone by itself.
    }
    return;
  }
  client_ = std::make_unique<Client>(std::move(*socket), board_);
  board_.tell(&client_->session.interrupts());
}

// Receives a message, or the part of it that has arrived.
void Server::serve() {
  try {
    std::optional<Message> message = client_->connection.receive();
    if (!message) return;
    const Bytes reply = client_->session.take(std::move(*message));
    if (!reply.empty() && !stopped_) client_->connection.send(reply);
  } catch (const Broken& e) {
    let_go(e.what());
  }
}

void Server::let_go(const char* why) {
  if (client_->session.open()) served_ = true;
  board_.tell(nullptr);
  client_.reset();
  if (*why != '\0') spdlog::warn("the client was let go: {}", why);
}

}  // namespace hvp::serve
