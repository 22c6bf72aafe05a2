// The arguments of `serve`.
#pragma once

#include "server/health_question.h"
#include "server/http_server.h"
#include "server/log_text.h"
#include "server/readiness.h"
#include "server/uploads.h"

#include <cstdint>
#include <optional>
#include <string>

namespace meshhier::app {

struct ServeArguments {
  std::string folder;
  server::ServerOptions server;
  bool open = false;
  std::string viewer;
  std::string cors;
  std::string frame;
  std::string inbox;
  bool takes_uploads = false;
  std::uint64_t upload_limit = server::UploadOptions().limit_bytes;
  std::string token_file;
  std::string metrics_token_file;
  std::uint64_t disk_floor = server::ReadinessOptions{}.disk_floor;
  server::LogFormat log_format = server::LogFormat::text;
  std::optional<server::Health> question;  ///< asked of a server that runs
  std::string config;
  double settle_seconds = 2;
  bool once = false;
  bool verbose = false;
  bool quiet = false;
};

}  // namespace meshhier::app
