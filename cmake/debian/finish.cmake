# Run by CPack after it made the packages. CPack adds scripts that only call
# ldconfig, for which Debian uses a trigger; they are removed.
foreach(package ${CPACK_PACKAGE_FILES})
  set(folder ${package}.contents)
  file(REMOVE_RECURSE ${folder})
  execute_process(COMMAND dpkg-deb -R ${package} ${folder}
    COMMAND_ERROR_IS_FATAL ANY)
  if(EXISTS ${folder}/DEBIAN/postinst)
    file(REMOVE ${folder}/DEBIAN/postinst ${folder}/DEBIAN/postrm)
    execute_process(
      COMMAND dpkg-deb --root-owner-group -Zxz -b ${folder} ${package}
      OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  endif()
  file(REMOVE_RECURSE ${folder})
endforeach()
