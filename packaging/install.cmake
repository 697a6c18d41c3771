# Where `cmake --install` puts what, and the Debian package of it. Everything is found from the program on: the folder
# can be moved.
include(GNUInstallDirs)
set(doc ${CMAKE_INSTALL_DATAROOTDIR}/doc/scancal)
install(TARGETS scancal RUNTIME DESTINATION bin)  # it looks for ../share/scancal/page: neither can be chosen
install(DIRECTORY report/page DESTINATION share/scancal PATTERN __pycache__ EXCLUDE)
install(DIRECTORY scripts/cluster DESTINATION share/scancal USE_SOURCE_PERMISSIONS)
install(DIRECTORY docs DESTINATION ${doc})
install(DIRECTORY data DESTINATION ${doc})
install(FILES README.md CHANGELOG.md CONVENTIONS.md DESTINATION ${doc})
install(FILES LICENSE DESTINATION ${doc} RENAME copyright)  # as Debian has it
install(FILES packaging/completion.bash DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/bash-completion/completions
  RENAME scancal)
install(CODE "execute_process(COMMAND ${SCANCAL_PYTHON} -B ${PROJECT_SOURCE_DIR}/packaging/manual.py \
  $<TARGET_FILE:scancal> OUTPUT_FILE ${CMAKE_BINARY_DIR}/scancal.1 COMMAND_ERROR_IS_FATAL ANY)")
install(FILES ${CMAKE_BINARY_DIR}/scancal.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)

set(SCANCAL_MAINTAINER "scancal <scancal@localhost>" CACHE STRING "Who answers for the Debian package: NAME <MAIL>")
set(CMAKE_SKIP_INSTALL_ALL_DEPENDENCY ON)  # the tests are not needed
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT ${SCANCAL_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "calibration of 3D scanners from geometric targets, with its uncertainty")
set(CPACK_PACKAGE_DESCRIPTION "A line profiler or lidar that turns against plates, a 3D scanner on a robot's flange that
sees balls, a ball on the flange in two sockets: offsets, hand-eye and kinematics
with uncertainties after the GUM, and the report that is filed.")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS
  "python3, python3-jinja2, python3-markupsafe, python3-matplotlib, python3-numpy, python3-fonttools, fonts-inter")
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "weasyprint")  # --pdf
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "bash-completion")
include(CPack)
