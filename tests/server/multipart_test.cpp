#include "server/multipart.h"

#include "tests/server/form_text.h"
#include "tests/server/text_body.h"

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace meshhier::server {
namespace {

using tests::form_text;
using tests::FormFiles;
using tests::kBoundary;
using tests::TextBody;
using Next = MultipartReader::Next;

/// Returns the files of a form; nothing if it is refused.
std::optional<FormFiles> read_form(const std::string& text, std::size_t body_piece = 1 << 20,
                                   std::size_t piece = 1 << 16) {
  TextBody body(text, {.most_at_once = body_piece});
  MultipartReader reader(body, kBoundary);
  FormFiles files;
  Next next = reader.next();
  for (; next == Next::file; next = reader.next()) {
    files.emplace_back(reader.name(), "");
    std::vector<std::byte> bytes(piece);
    while (const std::size_t count = reader.read(bytes))
      files.back().second.append(reinterpret_cast<const char*>(bytes.data()), count);
  }
  return next == Next::end ? std::optional(files) : std::nullopt;
}

TEST(MultipartTest, FilesComeOutAsTheyWentInHoweverTheyArrive) {
  const std::string nearly = "\r\n--" + kBoundary.substr(0, kBoundary.size() - 1);
  const FormFiles files{{"a.obj", "o a\r\n"},
                        {"empty.mtl", ""},
                        {"nearly.png", nearly + nearly + "\r\n\r\n--" + nearly + '\r'},
                        {"Grün & blau.bin", std::string(100'000, '\0')}};
  for (const std::size_t body_piece : {std::size_t{1}, std::size_t{41}, std::size_t{1} << 20}) {
    for (const std::size_t piece : {std::size_t{7}, std::size_t{1} << 18})
      EXPECT_EQ(read_form(form_text(files), body_piece, piece), files)
          << body_piece << ' ' << piece;
  }
}

TEST(MultipartTest, TheLongestHeadIsTheSameHoweverItArrives) {
  const std::string head = "Content-Disposition: form-data; name=\"f\"; filename=\"a.obj\"\r\nX: ";
  std::size_t longest = 0;
  for (std::size_t bytes = 4000; bytes < 4200; ++bytes) {
    const std::string text = "--" + kBoundary + "\r\n" + head +
                             std::string(bytes - head.size(), 'x') + "\r\n\r\nmesh\r\n--" +
                             kBoundary + "--\r\n";
    const std::optional<FormFiles> whole = read_form(text);
    EXPECT_EQ(read_form(text, 1), whole) << bytes;
    EXPECT_EQ(read_form(text, 41), whole) << bytes;
    if (whole)
      longest = bytes;
  }
  EXPECT_EQ(longest, 4096U);
}

TEST(MultipartTest, TheLastLineEndMayBeMissing) {
  std::string text = form_text({{"a.obj", "o"}});
  text.resize(text.size() - 2);
  EXPECT_EQ(read_form(text), (FormFiles{{"a.obj", "o"}}));
  EXPECT_EQ(read_form("--" + kBoundary + "--"), FormFiles());
}

TEST(MultipartTest, WhatEndsTooEarlyIsRefused) {
  const std::string text = form_text({{"a.obj", "some bytes"}, {"b.mtl", "and more"}});
  for (std::size_t bytes = 0; bytes < text.size() - 2; ++bytes)
    EXPECT_EQ(read_form(text.substr(0, bytes)), std::nullopt) << bytes;
  EXPECT_EQ(read_form(text.substr(0, text.size() - 1)), std::nullopt);
}

TEST(MultipartTest, WhatIsNoFormOfFilesIsRefused) {
  const std::string start = "--" + kBoundary + "\r\n";
  const std::string end = "\r\n\r\ncontent\r\n--" + kBoundary + "--\r\n";
  const std::string disposition = "Content-Disposition: form-data; name=\"f\"; filename=";
  EXPECT_NE(read_form(start + disposition + "\"a.obj\"" + end), std::nullopt);
  for (const std::string& text :
       {"preamble\r\n" + form_text({{"a.obj", "o"}}), form_text({{"a.obj", "o"}}) + "epilogue",
        form_text({{"a.obj", "o"}}) + form_text({{"a.obj", "o"}}),
        "--" + kBoundary + "x\r\n" + disposition + "\"a.obj\"" + end,
        start + "Content-Type: text/plain" + end, start + end,
        start + "Content-Disposition: form-data; name=\"f\"" + end,
        start + "Content-Disposition: attachment; filename=\"a.obj\"" + end,
        start + disposition + "\"a.obj" + end, start + disposition + "\"a\\\"b.obj\"" + end,
        start + disposition + "\"a.obj\"; filename=\"b.obj\"" + end,
        start + disposition + "\"a.obj\"\r\n" + disposition + "\"b.obj\"" + end,
        start + disposition + "\"a.obj\"; junk" + end, start + "Content-Disposition" + end,
        start + "X: " + std::string(5000, 'x') + "\r\n" + disposition + "\"a.obj\"" + end})
    EXPECT_EQ(read_form(text), std::nullopt) << text.substr(0, 200);
}

TEST(MultipartTest, TheBoundaryIsTakenFromTheType) {
  EXPECT_EQ(form_boundary("multipart/form-data; boundary=" + kBoundary), kBoundary);
  EXPECT_EQ(form_boundary("Multipart/Form-Data ;charset=utf-8; Boundary=\"a b:c\""), "a b:c");
  for (const std::string& type :
       {std::string(), std::string("multipart/form-data"),
        std::string("multipart/mixed; boundary=a"), std::string("multipart/form-data; boundary="),
        std::string("multipart/form-data; boundary=\"a "),
        std::string("multipart/form-data; boundary=\"a \""),
        std::string("multipart/form-data; boundary=a; boundary=b"),
        std::string("multipart/form-data; boundary=a\r\nb"),
        "multipart/form-data; boundary=" + std::string(71, 'a')})
    EXPECT_EQ(form_boundary(type), std::nullopt) << type;
}

}  // namespace
}  // namespace meshhier::server
