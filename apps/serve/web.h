#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

/// An HTTP server on GNU libmicrohttpd: one thread, bounded memory for each connection.
namespace headpin::apps {

struct WebRequest {
  std::string method, path;  ///< path without its query
  std::string body = {};
  std::function<std::string(const char* name)> query = {};  ///< empty where there is none
};

struct WebAnswer {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body = {};
};

/// A PEM certificate with its key.
struct Certificate {
  std::string certificate, key;
  std::string sha256;  ///< of a self-made one, as browsers show it
};

class WebServer {
 public:
  struct Options {
    std::string address = "127.0.0.1";
    int port = 0;  ///< 0: any free one
    std::optional<Certificate> certificate;
  };
  /// The largest body of a request, decided from what comes before it.
  /// @throws  as `answer`
  using Most = std::function<std::size_t(const WebRequest&)>;
  /// Is called by one thread at a time. Exceptions become answers: Refused its own, others 500.
  using Answer = std::function<WebAnswer(const WebRequest&)>;

  /// Starts to answer.
  /// @throws base::Busy          naming address and port, when the port is taken
  /// @throws UsageError          when the address is none of this machine
  /// @throws std::runtime_error  naming address and port, when they cannot be used otherwise
  WebServer(const Options& options, Most most, Answer answer);
  /// Closes all connections.
  ~WebServer();
  WebServer(const WebServer&) = delete;
  WebServer& operator=(const WebServer&) = delete;

  int port() const;

 private:
  struct Daemon;
  std::unique_ptr<Daemon> daemon_;
};

}  // namespace headpin::apps
