# Completion in bash for lambent, lambent-demo and lambent-editor: offers what --help of the program, or of its command, lists.
_lambent() {
  local program=$1 cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} help commands choices
  help=$("$program" --help 2>/dev/null)
  commands=$(sed -n '/^Subcommands:/,/^$/s/^  \([a-z]\+\) .*/\1/p' <<<"$help")
  if [[ $commands && $COMP_CWORD -gt 1 ]]; then
    help=$("$program" "${COMP_WORDS[1]}" --help 2>/dev/null)
    commands=
  fi
  if [[ $cur == -* ]]; then
    COMPREPLY=($(compgen -W "$(grep '^  -' <<<"$help" | grep -oE '^  (-[a-z],)?--[a-z0-9-]+' | grep -oE -- '--.*')" -- "$cur"))
  elif [[ $commands ]]; then
    COMPREPLY=($(compgen -W "$commands" -- "$cur"))
  else
    # The words in the type of a value, as "auto" in "N|auto".
    [[ $prev == -* ]] && choices=$(sed -n "s/^  \(-[a-z],\)\?$prev \([^ =]*|[^ =]*\).*/\2/p" <<<"$help" | tr '|' '\n' | grep -E '^[a-z-]+$')
    if [[ $choices ]]; then
      COMPREPLY=($(compgen -W "$choices" -- "$cur"))
    else
      COMPREPLY=($(compgen -f -- "$cur"))
    fi
  fi
}
complete -o filenames -F _lambent lambent lambent-demo lambent-editor
