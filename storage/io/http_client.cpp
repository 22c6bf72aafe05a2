#include "storage/io/http_client.h"

#include "base/error.h"
#include "storage/io/http_head.h"
#include "storage/io/web_address.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <mutex>
#include <new>
#include <span>
#include <thread>
#include <utility>

#include <curl/curl.h>
#include <fmt/format.h>

namespace meshhier::storage {
namespace {

using namespace std::chrono_literals;

constexpr long kConnectSeconds = 30;
constexpr int kMostRedirects = 10;
constexpr int kMostTries = 5;
constexpr std::chrono::milliseconds kMostWait = 60s;  ///< however long the host asks for

/// The most bytes of one answer's header; those of hosts of files have some hundred.
constexpr std::size_t kMostHead = std::size_t{64} << 10;
/// libcurl fails with this where a line of a header has more than 100 kB (since 8.6).
constexpr auto kLineTooLong = static_cast<CURLcode>(100);

constexpr long kWhole = 200, kPart = 206, kNotSatisfiable = 416;

bool may_pass(CURLcode code) {
  switch (code) {
    case CURLE_COULDNT_RESOLVE_HOST:
    case CURLE_COULDNT_CONNECT:
    case CURLE_OPERATION_TIMEDOUT:
    case CURLE_GOT_NOTHING:
    case CURLE_SEND_ERROR:
    case CURLE_RECV_ERROR:
    case CURLE_PARTIAL_FILE:
    case CURLE_HTTP2:
    case CURLE_HTTP2_STREAM:
      return true;
    default:
      return false;
  }
}

bool may_pass(long status) {
  return status == 408 || status == 425 || status == 429 || (status >= 500 && status != 501);
}

/// One request on its way.
struct Transfer {
  CURL* handle = nullptr;
  const std::function<void()>& check;
  std::uint64_t first = 0, count = 0;
  HttpAnswer& answer;
  std::uint64_t before = 0;  ///< bytes of earlier tries in the answer
  HttpHead head;
  bool is_too_much = false;
  std::exception_ptr thrown;
};

std::size_t take_header(char* data, std::size_t size, std::size_t count, void* to) {
  HttpHead& head = static_cast<Transfer*>(to)->head;
  head.add({data, size * count});
  return head.bytes > kMostHead ? 0 : size * count;
}

/// Whether the header is too large to be taken. For one long line libcurl hands over nothing and
/// only fails.
bool is_head_too_large(const HttpHead& head, CURLcode code) {
  return head.bytes > kMostHead ||
         (!head.is_complete && (code == CURLE_OUT_OF_MEMORY || code == kLineTooLong));
}

long status_of(CURL* handle) {
  long status = 0;
  curl_easy_getinfo(handle, CURLINFO_RESPONSE_CODE, &status);
  return status;
}

std::size_t take_body(char* data, std::size_t size, std::size_t count, void* to) {
  auto& transfer = *static_cast<Transfer*>(to);
  const std::span<const std::byte> bytes = std::as_bytes(std::span(data, size * count));
  const long status = status_of(transfer.handle);
  if (status != kWhole && status != kPart)
    return bytes.size();  // a page for people about an error: passed over
  HttpAnswer& answer = transfer.answer;
  if (status == kWhole && !answer.is_whole) {
    answer.bytes.clear();
    answer.is_whole = true;
  }
  const std::uint64_t most = answer.is_whole ? HttpClient::kMostWhole : transfer.count;
  transfer.is_too_much = answer.bytes.size() + bytes.size() > most;
  if (transfer.is_too_much)
    return 0;
  try {
    answer.bytes.insert(answer.bytes.end(), bytes.begin(), bytes.end());
  } catch (...) {
    transfer.thrown = std::current_exception();
    return 0;
  }
  return bytes.size();
}

int look_up(void* to, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  auto& transfer = *static_cast<Transfer*>(to);
  try {
    transfer.check();
    return 0;
  } catch (...) {
    transfer.thrown = std::current_exception();
    return 1;
  }
}

[[noreturn]] void fail(const HttpAddress& address, const std::string& what) {
  throw Error(ErrorCode::io, fmt::format("{}: {}", address.shown, what));
}

std::string refusal(long status) {
  switch (status) {
    case 401:
    case 403:
      return fmt::format(
          "the host does not let everybody read it ({}); give credentials in "
          "~/.netrc or with --header",
          status);
    default:
      return fmt::format("the host answered {}", status);
  }
}

/// A file of certificates instead of the system's, as curl takes it; null: there is none.
const char* other_authorities() {
  for (const char* name : {"CURL_CA_BUNDLE", "SSL_CERT_FILE"}) {
    const char* const file = std::getenv(name);
    if (file != nullptr && *file != '\0')
      return file;
  }
  return nullptr;
}

/// Sets libcurl up, once a process, before there are threads that use it.
void set_up() {
  static const CURLcode code = curl_global_init(CURL_GLOBAL_DEFAULT);
  if (code != CURLE_OK)
    throw Error(ErrorCode::io, fmt::format("cannot use libcurl: {}", curl_easy_strerror(code)));
}

}  // namespace

/// A connection that is used again and again, by one thread at a time.
class HttpClient::Connection {
 public:
  Connection(const HttpOptions& options, const std::function<void()>& check)
      : check_(check),
        first_wait_(options.first_wait),
        headers_(list_of(options.headers)),
        handle_(curl_easy_init()) {
    if (handle_ == nullptr)
      throw std::bad_alloc();
    set(CURLOPT_NOSIGNAL, 1L);
    set(CURLOPT_PROTOCOLS_STR, "http,https");
    set(CURLOPT_NETRC, long{CURL_NETRC_OPTIONAL});
    set(CURLOPT_CONNECTTIMEOUT, kConnectSeconds);
    set(CURLOPT_LOW_SPEED_LIMIT, 1L);
    set(CURLOPT_LOW_SPEED_TIME, static_cast<long>(options.silence.count()));
    set(CURLOPT_USERAGENT, "meshhier");
    set(CURLOPT_NOPROGRESS, 0L);
    set(CURLOPT_XFERINFOFUNCTION, look_up);
    set(CURLOPT_HEADERFUNCTION, take_header);
    set(CURLOPT_WRITEFUNCTION, take_body);
    if (const char* const authorities = other_authorities())
      set(CURLOPT_CAINFO, authorities);
    set(CURLOPT_MAX_RECV_SPEED_LARGE, static_cast<curl_off_t>(options.bytes_per_second));
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() { curl_easy_cleanup(handle_); }

  /// Adds to `answer` what is missing of the part, or fills it with the whole. Returns false if
  /// there is no such file.
  bool get(const HttpAddress& address, std::uint64_t first, std::uint64_t count,
           HttpAnswer& answer) {
    bool is_there = true;
    persist(address, [&] {
      if (answer.is_whole)
        answer = {};  // a whole answer that broke off: it may come as a whole again, or in parts
      const std::uint64_t got = answer.bytes.size();
      set(CURLOPT_HTTPGET, 1L);
      set(CURLOPT_RANGE, fmt::format("{}-{}", first + got, first + count - 1).c_str());
      Transfer transfer{handle_, check_, first + got, count, answer, got, {}, false, nullptr};
      const CURLcode code = perform(address, transfer);
      const long status = status_of(handle_);
      is_there = code != CURLE_OK || (status != 404 && status != 410);
      return is_there ? settle(address, transfer, code) : std::string();
    });
    return is_there;
  }

  std::uint64_t bytes = 0;     ///< count since this was set to 0
  std::uint64_t requests = 0;  ///< likewise

 private:
  template <class Value>
  void set(CURLoption option, Value value) {
    curl_easy_setopt(handle_, option, value);
  }

  /// Asks, and follows redirects. libcurl would take all headers but Authorization and Cookie to
  /// any host.
  CURLcode perform(const HttpAddress& address, Transfer& transfer) {
    const WebAddressParts own = address_parts(address.url);
    std::string url = address.url;
    for (int redirects = 0; redirects <= kMostRedirects; ++redirects) {
      introduce(own, address_parts(url).origin == own.origin);
      const CURLcode code = ask(url, transfer);
      const char* target = nullptr;
      curl_easy_getinfo(handle_, CURLINFO_REDIRECT_URL, &target);
      if (code != CURLE_OK || target == nullptr)
        return code;
      url = target;
    }
    return CURLE_TOO_MANY_REDIRECTS;
  }

  /// Gives headers, and the address's user and password, to its own host alone.
  void introduce(const WebAddressParts& own, bool is_own) {
    set(CURLOPT_HTTPHEADER, is_own ? headers_.get() : nullptr);
    set(CURLOPT_USERNAME, is_own && own.user ? own.user->c_str() : nullptr);
    set(CURLOPT_PASSWORD, is_own && own.password ? own.password->c_str() : nullptr);
  }

  CURLcode ask(const std::string& url, Transfer& transfer) {
    set(CURLOPT_URL, url.c_str());
    set(CURLOPT_HEADERDATA, &transfer);
    set(CURLOPT_WRITEDATA, &transfer);
    set(CURLOPT_XFERINFODATA, &transfer);
    const CURLcode code = curl_easy_perform(handle_);
    curl_off_t size = 0;
    curl_easy_getinfo(handle_, CURLINFO_SIZE_DOWNLOAD_T, &size);
    bytes += static_cast<std::uint64_t>(size);
    ++requests;
    if (transfer.thrown)
      std::rethrow_exception(transfer.thrown);
    return code;
  }

  /// Returns a failure that may pass, in words, or nothing if all is there; throws what will not
  /// pass.
  std::string settle(const HttpAddress& address, Transfer& transfer, CURLcode code) {
    require_sound(address, transfer, code);
    HttpAnswer& answer = transfer.answer;
    const long status = status_of(handle_);
    // The bytes that have come stay, however it broke off: the next try must know of which file it
    // is.
    const bool has_begun = transfer.head.is_complete && (status == kWhole || status == kPart);
    if (code != CURLE_OK && code != CURLE_PARTIAL_FILE && !has_begun)
      return failed(address, code);
    if (status == kNotSatisfiable && transfer.before == 0) {  // the file ends before
      answer.total = transfer.head.total;
      answer.version = transfer.head.version();
      return {};
    }
    if (status != kWhole && status != kPart)
      return passing(address, may_pass(status), refusal(status));
    if (status == kPart && transfer.head.first.value_or(transfer.first) != transfer.first)
      fail(address, "the host sent another part than was asked for");
    note(address, transfer, status);
    return code == CURLE_OK ? std::string() : failed(address, code);
  }

  static void require_sound(const HttpAddress& address, const Transfer& transfer, CURLcode code) {
    if (is_head_too_large(transfer.head, code))
      fail(address,
           fmt::format("the header of the host's answer has more than {} bytes", kMostHead));
    if (!transfer.head.impossible.empty())
      fail(address, fmt::format("the host says that it has {} bytes, as no file has",
                                transfer.head.impossible));
    if (transfer.is_too_much && transfer.answer.is_whole) {
      fail(address, fmt::format("the host sends files whole, but no parts of them (HTTP ranges), "
                                "and this one has more than {} bytes",
                                kMostWhole));
    }
    if (transfer.is_too_much) {
      fail(address, transfer.head.encoding.empty()
                        ? "the host sent more than the part that was asked for"
                        : kSentPacked);
    }
  }

  void note(const HttpAddress& address, const Transfer& transfer, long status) {
    HttpAnswer& answer = transfer.answer;
    const std::string version = transfer.head.version();
    if (transfer.before > 0 && answer.version != version)
      fail(address, "it has become another file on the host while it was read");
    answer.version = version;
    answer.encoding = transfer.head.encoding;
    answer.total = status == kWhole ? transfer.head.length : transfer.head.total;
  }

  static std::string failed(const HttpAddress& address, CURLcode code) {
    return passing(address, may_pass(code),
                   code == CURLE_PEER_FAILED_VERIFICATION
                       ? "its certificate is not valid, so nobody knows who answers; "
                         "CURL_CA_BUNDLE, else SSL_CERT_FILE, can name a file of other authorities"
                       : curl_easy_strerror(code));
  }

  /// Returns a failure that may pass, throws another one.
  static std::string passing(const HttpAddress& address, bool may_pass, std::string what) {
    if (!may_pass)
      fail(address, what);
    return what;
  }

  /// Calls `attempt` until it returns no failure, waiting longer each time.
  void persist(const HttpAddress& address, const std::function<std::string()>& attempt) {
    std::chrono::milliseconds pause = first_wait_;
    for (int tries = 1;; ++tries, pause *= 2) {
      const std::string what = attempt();
      if (what.empty())
        return;
      if (tries == kMostTries)
        fail(address, fmt::format("{}, {} times", what, kMostTries));
      curl_off_t asked = 0;
      curl_easy_getinfo(handle_, CURLINFO_RETRY_AFTER, &asked);
      const std::chrono::milliseconds wished = std::chrono::seconds(asked);
      wait(std::min(std::max(pause, wished), kMostWait));
    }
  }

  void wait(std::chrono::milliseconds time) {
    constexpr std::chrono::milliseconds kStep = 50ms;
    for (; time > 0ms; time -= kStep) {
      check_();
      std::this_thread::sleep_for(std::min(time, kStep));
    }
  }

  using List = std::unique_ptr<curl_slist, void (*)(curl_slist*)>;

  static List list_of(const std::vector<std::string>& lines) {
    List list(nullptr, curl_slist_free_all);
    for (const std::string& line : lines) {
      curl_slist* const more = curl_slist_append(list.get(), line.c_str());
      if (more == nullptr)
        throw std::bad_alloc();
      (void)list.release();
      list.reset(more);
    }
    return list;
  }

  const std::function<void()>& check_;
  std::chrono::milliseconds first_wait_;
  List headers_;
  CURL* handle_;
};

struct HttpClient::Idle {
  std::mutex mutex;
  std::vector<std::unique_ptr<Connection>> connections;
  std::mutex one_at_a_time;  ///< where there is a limit: it is a connection's
};

/// A connection as long as one thread needs it.
class HttpClient::Lease {
 public:
  explicit Lease(HttpClient& client)
      : client_(client), alone_(client.idle_->one_at_a_time, std::defer_lock) {
    if (client.options_.bytes_per_second > 0)
      alone_.lock();
    const std::lock_guard lock(client.idle_->mutex);
    auto& idle = client.idle_->connections;
    if (idle.empty()) {
      connection_ = std::make_unique<Connection>(client.options_, client.check_);
      return;
    }
    connection_ = std::move(idle.back());
    idle.pop_back();
  }
  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;
  ~Lease() {
    client_.counters_.bytes += std::exchange(connection_->bytes, 0);
    client_.counters_.requests += std::exchange(connection_->requests, 0);
    const std::lock_guard lock(client_.idle_->mutex);
    client_.idle_->connections.push_back(std::move(connection_));
  }

  Connection& connection() { return *connection_; }

 private:
  HttpClient& client_;
  std::unique_lock<std::mutex> alone_;
  std::unique_ptr<Connection> connection_;
};

HttpClient::HttpClient(HttpOptions options, std::function<void()> check)
    : options_(std::move(options)),
      check_([this, check = std::move(check)] {
        if (is_over_)
          throw Error(ErrorCode::interrupted, "nobody waits for it any more");
        check();
      }),
      idle_(std::make_unique<Idle>()) {
  set_up();
}
HttpClient::~HttpClient() = default;

HttpAnswer HttpClient::get(const HttpAddress& address, std::uint64_t first, std::uint64_t count) {
  std::optional<HttpAnswer> answer = find(address, first, count);
  if (!answer)
    fail(address, "there is no such file on the host");
  return std::move(*answer);
}

std::optional<HttpAnswer> HttpClient::find(const HttpAddress& address, std::uint64_t first,
                                           std::uint64_t count) {
  HttpAnswer answer;
  Lease lease(*this);
  if (!lease.connection().get(address, first, count, answer))
    return std::nullopt;
  return answer;
}

}  // namespace meshhier::storage
