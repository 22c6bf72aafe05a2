#include "app/command.h"
#include "app/completion.h"

#include <map>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace meshhier::app {

namespace {

// Each script asks "meshhier complete meshhier WORD..." at every Tab, with the words up to the
// cursor. The first line of the answer is "files" or "words"; then come lines of a word, a tab, and
// its meaning.

constexpr const char* kBash = R"(# Completion of meshhier in bash.
_meshhier() {
  local kind word typed= head= words=("$1") files=() i
  for ((i = 1; i <= COMP_CWORD; ++i)); do  # bash splits words at "="
    if ((i > 1)) && [[ ${COMP_WORDS[i]} == = || ${COMP_WORDS[i - 1]} == = ]]; then
      words[-1]+=${COMP_WORDS[i]}
    else
      words+=("${COMP_WORDS[i]}")
    fi
  done
  typed=${words[-1]}
  [[ $typed != *=* || $COMP_WORDBREAKS != *=* ]] || head=${typed%%=*}=
  COMPREPLY=()
  {
    read -r kind
    while IFS=$'\t' read -r word _; do COMPREPLY+=("${word#"$head"}"); done
  } < <("$1" complete "${words[@]}" 2>/dev/null)
  [[ ${COMPREPLY[0]-} != *= ]] || compopt -o nospace
  if [[ $kind == files ]]; then
    mapfile -t files < <(compgen -f -- "${typed#"$head"}")
    COMPREPLY+=("${files[@]}")
    compopt -o filenames
  fi
}
complete -F _meshhier meshhier
)";

constexpr const char* kZsh = R"(#compdef meshhier
# Completion of meshhier in zsh.
_meshhier() {
  local line
  local -a lines ready open
  lines=("${(@f)$("${(Q)words[1]}" complete "${(@Q)words[1,CURRENT]}" 2>/dev/null)}")
  for line in "${(@)lines[2,-1]}"; do
    line=${${line//:/\\:}/$'\t'/:}
    if [[ ${line%%:*} == *= ]]; then open+=("$line"); else ready+=("$line"); fi
  done
  (($#ready)) && _describe -t values value ready
  (($#open)) && _describe -t keys key open -S ''
  if [[ $lines[1] == files ]]; then
    compset -P '*='
    _files
  fi
}
if [[ $funcstack[1] == _meshhier ]]; then _meshhier "$@"; else compdef _meshhier meshhier; fi
)";

constexpr const char* kFish = R"(# Completion of meshhier in fish.
function __meshhier_complete
  set -l words (commandline -opc)
  set -l answer ($words[1] complete $words (commandline -ct) 2>/dev/null)
  printf '%s\n' $answer[2..-1]
  if test "$answer[1]" = files
    set -l typed (commandline -ct)
    set -l head (string match -r '^[^=]*=' -- $typed; or echo '')
    printf '%s\n' $head(__fish_complete_path (string replace -r '^[^=]*=' '' -- $typed))
  end
end
complete -c meshhier -f -a '(__meshhier_complete)'
)";

const std::map<std::string, const char*>& scripts() {
  static const std::map<std::string, const char*> all{
      {"bash", kBash}, {"fish", kFish}, {"zsh", kZsh}};
  return all;
}

constexpr const char* kCompletionFooter =
    R"(The Debian package and scripts/install put these scripts in place. Elsewhere:
  source <(meshhier completion bash)                           in ~/.bashrc
  source <(meshhier completion zsh)                            in ~/.zshrc, after compinit
  meshhier completion fish | source                            in ~/.config/fish/config.fish
)";

void print(const Completion& completion, std::ostream& out) {
  out << (completion.takes_files ? "files" : "words") << '\n';
  for (const auto& [word, meaning] : completion.suggestions)
    out << word << '\t' << meaning << '\n';
}

/// Adds the command that the scripts call; it is of no use to people. All that follows the first
/// word, the program's name, is left as it is, options too.
void add_complete_command(CLI::App& parser, Invocation& invocation) {
  CLI::App* command = parser.add_subcommand("complete", "Answer a shell's completion script");
  command->group("")->prefix_command();
  command->callback([command, &parser, &invocation] {
    std::vector<std::string> words = command->remaining();
    if (!words.empty())
      words.erase(words.begin());
    invocation.run = [words = std::move(words), &parser](Environment& environment) {
      print(complete(parser, words), environment.out);
      return 0;
    };
  });
}

}  // namespace

void add_completion_command(CLI::App& parser, Invocation& invocation) {
  const auto shell = std::make_shared<std::string>();
  CLI::App* command =
      parser.add_subcommand("completion", "Print the script that completes words in a shell");
  command->add_option("SHELL", *shell, "bash, fish or zsh")
      ->required()
      ->check(CLI::IsMember(scripts()));
  command->footer(kCompletionFooter);
  command->callback([shell, &invocation] {
    invocation.run = [shell](Environment& environment) {
      environment.out << scripts().at(*shell);
      return 0;
    };
  });
  add_complete_command(parser, invocation);
}

}  // namespace meshhier::app
