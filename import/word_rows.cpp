#include "import/word_rows.h"

#include "import/row_sort.h"
#include "storage/format/object_words.h"

#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace meshhier::importing {
namespace {

/// Puts together what comes by word, then by object.
class WordRows {
 public:
  explicit WordRows(const std::function<void(ObjectRow row)>& visit) : visit_(visit) {}

  void add(std::string_view word, std::uint32_t object) {
    const bool is_same = !objects_.empty() && word == word_;
    if (is_same && object == objects_.back())
      return;  // a name that has it twice
    if (!is_same || objects_.size() == storage::kMostWordObjects)
      flush();
    word_ = word;
    objects_.push_back(object);
  }

  void flush() {
    if (!objects_.empty())
      visit_(storage::word_row(word_, objects_));
    objects_.clear();
  }

 private:
  const std::function<void(ObjectRow row)>& visit_;
  std::string word_;
  std::vector<std::uint32_t> objects_;
};

}  // namespace

void for_each_word_row(const storage::ObjectTable& objects, const storage::LetterTable& letters,
                       const ImportRoom& room, const std::function<void(ObjectRow row)>& visit) {
  RowSort sort(room, room.sort_bytes);
  objects.for_each([&](std::uint32_t object, const ObjectRow& row) {
    room.cancel.check();
    char bytes[sizeof(object)];
    std::memcpy(bytes, &object, sizeof(object));
    for (const std::string& word : letters.words_of(row.name))
      sort.add({word, {bytes, sizeof(bytes)}});
  });
  sort.sort();
  WordRows rows(visit);
  while (sort.next()) {
    room.cancel.check();
    std::uint32_t object = 0;
    std::memcpy(&object, sort.row().bytes.data(), sizeof(object));
    rows.add(sort.row().key, object);
  }
  rows.flush();
}

}  // namespace meshhier::importing
