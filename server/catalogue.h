// The models of a folder at one moment, found by words and put in orders, a page at a time.
//
// Problem: a page with a window of twenty cells asks for a list of 10,000, 3 MB, and does all
//   searching and sorting itself.
// Idea: a request says what it looks for, in which order, and which part of that it wants. Words
//   are folded and ranks in each order by name are made once, when the folder has changed; a
//   request then passes over all of them, and sorts numbers. Each catalogue has a name: parts that
//   name it fit together.
// Cost: about 1 ms a request of 10,000 models; 0.1 kB a model besides what is known of it.
#pragma once

#include "server/model.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace meshhier::server {

enum class ModelOrder { folder, name, newest, size, triangles };

/// What a request for models.json wants:
/// "/models.json?search=marble&order=newest&first=200&count=100".
struct ListingWish {
  std::string search{};  ///< words; a model has each in its name, title, tags or folder
  std::string tag{};     ///< empty: any
  std::string path{};    ///< of one model; empty: all
  ModelOrder order = ModelOrder::folder;
  std::size_t first = 0;
  std::size_t count = 0;
  bool wants_places = false;  ///< where they lie, instead of the models
  std::string state{};        ///< of the catalogue that it belongs to; empty: the present one
};

/// Returns the wish of a target's query; nothing if it asks for no part: then it is for all models,
/// by path. What is no value of a key counts as not said.
std::optional<ListingWish> read_wish(std::string_view target);

/// Thread-safe.
class Catalogue {
 public:
  /// `models`: by path.
  explicit Catalogue(std::vector<Model> models);

  const std::vector<Model>& models() const { return models_; }
  /// Returns the catalogue's name: another one whenever a listing would be another one.
  const std::string& state() const { return state_; }
  /// Returns the models that a wish finds, in its order, by their numbers in models().
  std::vector<std::uint32_t> find(const ListingWish& wish) const;
  /// Returns how many of these models have each tag: the most frequent ones first, at most `most`.
  std::vector<std::pair<std::string, std::size_t>> tags(const std::vector<std::uint32_t>& found,
                                                        std::size_t most) const;

 private:
  /// Places in the orders that are by text alone.
  struct Ranks {
    std::uint32_t by_name = 0, by_folder = 0;
  };
  std::vector<Model> models_;
  std::vector<std::string> words_;  ///< of each model, folded, with a space between them
  std::vector<Ranks> ranks_;
  std::string state_;
};

/// Returns the folder that people see a model in: its description's, else its directory.
std::string_view folder_of(const Model& model);
/// Returns the name that people see.
const std::string& shown_name(const Model& model);

}  // namespace meshhier::server
