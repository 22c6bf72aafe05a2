#include "import/object_list.h"

#include "import/row_bytes.h"
#include "partition/external_sort.h"

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace meshhier::importing {
namespace {

/// An object on its way through the sorts.
struct Listed {
  std::uint32_t number = 0;  ///< that its reader gave
  std::string id, name;
  ObjectValues values;
};

/// `key` ends before a zero; behind it is what orders objects of the same key.
void add_listed(RowSort& sort, const std::string& key, const std::string& then,
                const Listed& object) {
  std::string bytes;
  put_raw(bytes, object.number);
  put_text(bytes, object.id);
  put_text(bytes, object.name);
  bytes += encode_values(object.values);
  sort.add({key + '\0' + then, bytes});
}

Listed listed_in(std::string_view bytes) {
  Listed object;
  object.number = take_raw<std::uint32_t>(bytes);
  object.id = take_text(bytes);
  object.name = take_text(bytes);
  object.values = decode_values(bytes);
  return object;
}

struct NumberPair {
  std::uint32_t given, listed;
};
struct GivenKey {
  std::uint32_t operator()(const NumberPair& pair) const { return pair.given; }
};

/// One making of a list.
class Lister {
 public:
  Lister(const MeshObjects& objects, PropertyTable* table, PropertyTypes& types,
         storage::File& file, ObjectList& list, const ImportRoom& room)
      : objects_(objects),
        table_(table),
        types_(types),
        file_(file),
        list_(list),
        room_(room),
        memory_(room.sort_bytes / 2) {}

  void run() {
    const bool have_ids = objects_.names.have_ids();
    auto by_name = std::make_unique<RowSort>(room_, memory_);
    {
      RowSort by_key(room_, memory_);
      add_found(by_key);
      by_key.sort();
      join(by_key, have_ids, *by_name);
    }
    by_name->sort();
    // A name with an id behind it may be another one's as it is.
    for (bool is_changed = have_ids; is_changed;) {
      auto renamed = std::make_unique<RowSort>(room_, memory_);
      is_changed = tell_apart(*by_name, *renamed);
      renamed->sort();
      by_name = std::move(renamed);
    }
    write(*by_name);
  }

 private:
  bool is_known_by_id(const std::string& id) const {
    return !id.empty() && (table_ == nullptr || table_->knows_ids());
  }

  void add_found(RowSort& by_key) {
    objects_.names.for_each([&](std::uint32_t number, FoundObject object) {
      for (const auto& [property, value] : object.values)
        types_.note(property, value, mesh_io::RecordTexts::texts);
      const std::string key = is_known_by_id(object.id) ? object.id : object.name;
      const std::string name = object.name;
      // Of one id, a name that is more than the id comes first; no UTF-8 has that byte.
      const std::string then = name == object.id ? "\xFF" : name;
      add_listed(by_key, key, then, {number, object.id, name, std::move(object.values)});
    });
  }

  /// Gives each object the name and the values that the table has for it. Objects of one id get one
  /// name.
  void join(RowSort& by_key, bool have_ids, RowSort& by_name) {
    std::string last, last_id, name;
    bool is_first = true;
    while (by_key.next()) {
      const std::string_view all = by_key.row().key;
      Listed object = listed_in(by_key.row().bytes);
      const bool is_same_id = is_known_by_id(object.id) && object.id == last_id;
      const bool is_new = is_first || (all != last && !is_same_id);
      is_first = false;
      last = all;
      last_id = object.id;
      if (is_same_id)
        object.name = name;
      if (table_ != nullptr)
        take_row(std::string_view(last).substr(0, last.find('\0')), is_new, object);
      name = object.name;
      const std::string& then = have_ids ? object.id : std::string();
      add_listed(by_name, object.name, then, object);
    }
  }

  void take_row(std::string_view key, bool is_new, Listed& object) {
    const bool by_id = is_known_by_id(object.id);
    const PropertyTable::Found* row =
        object.name.empty() && !by_id ? nullptr : table_->find(key, by_id);
    if (row == nullptr) {
      if (is_new && !object.name.empty() && list_.without_row++ == 0)
        list_.first_without_row = key;
      return;
    }
    if (by_id && !row->name.empty())
      object.name = sound_name(row->name);
    if (is_new)
      object.values.insert(object.values.begin(), row->values.begin(), row->values.end());
  }

  /// Objects of one name that have different ids get these behind it, but for the first. Returns
  /// whether there are any.
  bool tell_apart(RowSort& by_name, RowSort& renamed) {
    std::string name, id;
    bool is_first = true, is_any = false;
    while (by_name.next()) {
      Listed object = listed_in(by_name.row().bytes);
      if (is_first || object.name != name) {
        name = object.name;
        id = object.id;
      } else if (object.id != id) {
        object.name = fmt::format("{} ({})", object.name, object.id);
        is_any = true;
      }
      is_first = false;
      add_listed(renamed, object.name, object.id, object);
    }
    return is_any;
  }

  void write(RowSort& by_name) {
    std::vector<ObjectProperty> properties;
    for (std::size_t i = 0; i < objects_.properties.all().size(); ++i)
      properties.push_back(
          {objects_.properties.all()[i], types_.type(static_cast<std::uint8_t>(i))});
    storage::ObjectTableWriter writer(file_, properties);
    partition::ExternalSort<NumberPair, GivenKey> numbers(room_.scratch, memory_);
    ObjectRow row;
    std::uint32_t listed = 0;
    bool is_any = false;
    while (by_name.next()) {
      Listed object = listed_in(by_name.row().bytes);
      const bool is_new = !is_any || object.name != row.name;
      if (is_new && is_any) {
        writer.add(std::move(row));
        ++listed;
      }
      if (is_new) {
        row = {};
        row.name = object.name;
        row.values.resize(properties.size());
      }
      is_any = true;
      fill(row, std::move(object.values));
      numbers.add({object.number, listed});
    }
    if (is_any)
      writer.add(std::move(row));
    list_.facts = writer.finish();
    take_numbers(numbers);
  }

  void fill(ObjectRow& row, ObjectValues values) const {
    for (auto& [property, value] : values) {
      if (std::holds_alternative<std::monostate>(row.values[property]))
        row.values[property] = types_.converted(property, std::move(value));
    }
  }

  void take_numbers(partition::ExternalSort<NumberPair, GivenKey>& numbers) {
    numbers.sort();
    numbers.for_each_block([&](std::span<const NumberPair> block) {
      room_.cancel.check();
      for (const NumberPair& pair : block)
        list_.numbers.append(pair.listed);
    });
  }

  const MeshObjects& objects_;
  PropertyTable* table_;
  PropertyTypes& types_;
  storage::File& file_;
  ObjectList& list_;
  const ImportRoom& room_;
  std::uint64_t memory_;
};

}  // namespace

void list_objects(const MeshObjects& objects, PropertyTable* table, PropertyTypes& types,
                  storage::File& file, ObjectList& list, const ImportRoom& room) {
  Lister(objects, table, types, file, list, room).run();
}

}  // namespace meshhier::importing
