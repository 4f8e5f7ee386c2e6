# What an installation holds besides the programs, and the Debian package: `cmake --build … -t package`.
find_program(REGRASP_SCDOC scdoc REQUIRED)

# Manual pages from docs/man, which the tests compare with what the programs print.
set(pages)
foreach(page regrasp.1 regraspd.8 regrasp-protocol.7)
  set(made ${CMAKE_BINARY_DIR}/man/${page}.gz)
  add_custom_command(
    OUTPUT ${made}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/man
    COMMAND ${REGRASP_SCDOC} < ${PROJECT_SOURCE_DIR}/docs/man/${page}.scd | gzip -9n > ${made}
    DEPENDS ${PROJECT_SOURCE_DIR}/docs/man/${page}.scd VERBATIM)
  list(APPEND pages ${made})
  string(REGEX MATCH "[0-9]$" section ${page})
  install(FILES ${made} DESTINATION ${CMAKE_INSTALL_MANDIR}/man${section})
endforeach()

# The changelog where Debian looks for it.
set(changelog ${CMAKE_BINARY_DIR}/man/changelog.gz)
add_custom_command(
  OUTPUT ${changelog}
  COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/man
  COMMAND gzip -9n < ${PROJECT_SOURCE_DIR}/CHANGELOG.md > ${changelog}
  DEPENDS ${PROJECT_SOURCE_DIR}/CHANGELOG.md VERBATIM)
install(FILES ${changelog} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/regrasp)

# Completion, in the places where the shells of Debian look.
set(completions)
foreach(place bash:bash-completion/completions/regrasp zsh:zsh/vendor-completions/_regrasp
              fish:fish/vendor_completions.d/regrasp.fish)
  string(REGEX MATCH "^([a-z]+):(.*)/(.*)$" ignored ${place})
  set(shell ${CMAKE_MATCH_1})
  set(directory ${CMAKE_MATCH_2})
  set(made ${CMAKE_BINARY_DIR}/completion/${CMAKE_MATCH_3})
  add_custom_command(
    OUTPUT ${made}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/completion
    COMMAND regrasp completion ${shell} > ${made}
    DEPENDS regrasp VERBATIM)
  list(APPEND completions ${made})
  install(FILES ${made} DESTINATION ${CMAKE_INSTALL_DATADIR}/${directory})
endforeach()
add_custom_target(regrasp_extras ALL DEPENDS ${pages} ${changelog} ${completions})

# The unit names the daemon where it is installed, which is known only then.
install(CODE "
  set(REGRASPD \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_BINDIR}/regraspd\")
  configure_file(\"${CMAKE_CURRENT_LIST_DIR}/regraspd.service.in\"
                 \"${CMAKE_BINARY_DIR}/regraspd.service\" @ONLY)")
install(FILES ${CMAKE_BINARY_DIR}/regraspd.service ${CMAKE_CURRENT_LIST_DIR}/regraspd.socket
        DESTINATION lib/systemd/system)
install(FILES ${CMAKE_CURRENT_LIST_DIR}/copyright README.md
        DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/regrasp)
install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/regrasp)
# The Python module, where Debian's python3 looks for it.
install(DIRECTORY cli/python/regrasp DESTINATION lib/python3/dist-packages PATTERN __pycache__ EXCLUDE)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME regrasp)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "the regrasp authors <regrasp@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "simulated hand that grasps, explores and turns an object")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
    "A simulated 22-joint hand holds a ball it knows nothing about, improves
its grasp by sliding one finger over the surface, and turns the ball by
regrasping with one finger after the other. regraspd is the service,
regrasp its command line.")
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PROVIDES python3-regrasp)
set(CPACK_DEBIAN_PACKAGE_SUGGESTS python3)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS fonts-dejavu-core)  # the font of the pictures, found by path
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/postinst ${CMAKE_CURRENT_LIST_DIR}/prerm
                                       ${CMAKE_CURRENT_LIST_DIR}/postrm)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_STRIP_FILES ON)
include(CPack)
