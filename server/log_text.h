// The lines of a server's log: with time and level, as text or as JSON. Nothing that a client sends
// can end a line or begin another one.
//
//   2026-11-30T05:07:20.123Z info 127.0.0.1 GET /models.json?count=120 200 5120
//   2026-11-30T05:07:20.123Z warning scan.ply: a texture is lost
//   {"time":"2026-11-30T05:07:20.123Z","level":"warning","message":"scan.ply: a texture is lost"}
#pragma once

#include "base/named_value.h"
#include "server/http_server.h"

#include <array>
#include <chrono>
#include <string>
#include <string_view>

namespace meshhier::server {

enum class LogLevel { info, warning, error };
inline constexpr std::array kLogLevels{NamedValue{"info", LogLevel::info},
                                       NamedValue{"warning", LogLevel::warning},
                                       NamedValue{"error", LogLevel::error}};

enum class LogFormat { text, json };
inline constexpr std::array kLogFormats{NamedValue{"text", LogFormat::text},
                                        NamedValue{"json", LogFormat::json}};

using LogTime = std::chrono::system_clock::time_point;

/// Returns a time in UTC by ISO 8601, to the millisecond: "2026-11-30T05:07:20.123Z".
std::string utc_text(LogTime time);

/// Returns the line of a message, without its end. Control characters become '?'; a message has
/// 4096 bytes at the most.
std::string log_line(LogFormat format, LogTime time, LogLevel level, std::string_view message);

/// Returns the line of a request. Bytes other than visible ASCII are told as "\x1b". Of a query,
/// only values that this server has a meaning for are told, others are "...": they may be secrets.
std::string log_line(LogFormat format, LogTime time, const Served& served);

}  // namespace meshhier::server
