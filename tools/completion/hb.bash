# Completion of hb for bash: flags as the program itself names them, files, and the numbers of the scene on the line.
_hb() {
  local program=${COMP_WORDS[0]} word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]}
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    mapfile -t COMPREPLY < <(compgen -W "$("$program" --help | sed -n '/^Subcommands:/,$s/^  \([a-z]*\) .*/\1/p') --help --version" -- "$word")
    return
  fi
  local subcommand=${COMP_WORDS[1]} scene='' i
  # bash takes "=" for a word of its own: --set PATH=VALUE ends where its value begins.
  [[ $word == '=' || $before == '=' ]] && return
  case $before in
    --set | --set-b | --x | --y | --vary | --tie)
      for ((i = 2; i < COMP_CWORD; ++i)); do [[ ${COMP_WORDS[i]} == *.toml ]] && scene=${COMP_WORDS[i]}; done
      [[ $scene ]] || return
      local more=''
      [[ $before == --x || $before == --y ]] && more='rpm omega'
      mapfile -t COMPREPLY < <(compgen -S = -W "$more $("$program" scene "$scene" --paths 2>/dev/null | cut -d' ' -f1)" -- "$word")
      compopt -o nospace 2>/dev/null
      ;;
    --out) mapfile -t COMPREPLY < <(compgen -d -- "$word") ;;
    *)
      if [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$("$program" "$subcommand" --help 2>/dev/null | grep -oE -- '--[a-z-]+' | sort -u)" -- "$word")
      elif [[ $subcommand == new ]]; then
        mapfile -t COMPREPLY < <(compgen -W "slider-crank four-bar six-link hill" -- "$word")
      else
        mapfile -t COMPREPLY < <(compgen -f -X '!*.toml' -- "$word"; compgen -d -- "$word")
        compopt -o filenames 2>/dev/null
      fi
      ;;
  esac
}
complete -F _hb hb
