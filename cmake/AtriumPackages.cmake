# What `cmake --install` installs, and to which package it belongs: each package of debian/control is a component of the same name.
# Programs lie in lib/atrium/bin under their own names, because names such as `viewer` are too general for /usr/bin; there and in bin a
# link atrium-NAME leads to each.

set(atrium_bin lib/atrium/bin)
set(atrium_share share/atrium)

set(ATRIUM_HOST_LIB lib CACHE STRING "Folder that has systemd/system and udev/rules.d")

# atrium_command(NAME PROGRAM PACKAGE [FILE ...]): `atrium NAME` and `atrium-NAME` run PROGRAM. Its manual page and its completion in bash
# are made from its `--help`. Each FILE is a unit of deploy/units that runs PROGRAM. Does nothing where this build leaves PROGRAM out.
function(atrium_command name program package)
    if(NOT TARGET ${program})
        return()
    endif()
    set(command atrium-${name})
    set(link ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/${command})
    add_custom_command(OUTPUT ${link} COMMAND ${CMAKE_COMMAND} -E create_symlink ${program} ${link} DEPENDS ${program})
    set_property(GLOBAL APPEND PROPERTY atrium_links ${link})
    install(TARGETS ${program} RUNTIME DESTINATION ${atrium_bin} COMPONENT ${package})
    _atrium_install_link(${program} ${atrium_bin}/${command} ${package})
    _atrium_install_link(../lib/atrium/bin/${program} bin/${command} ${package})
    _atrium_manual(${command} ${program} ${package} ${link})
    foreach(unit ${ARGN})
        install(FILES deploy/units/${unit} DESTINATION ${ATRIUM_HOST_LIB}/systemd/system COMPONENT ${package})
    endforeach()
endfunction()

function(_atrium_install_link to path package)
    install(CODE "
        set(link \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${path}\")
        get_filename_component(folder \"\${link}\" DIRECTORY)
        file(MAKE_DIRECTORY \"\${folder}\")
        file(CREATE_LINK ${to} \"\${link}\" SYMBOLIC)" COMPONENT ${package})
endfunction()

# Runs the program, so builds with sanitizers do without.
function(_atrium_manual command program package link)
    if(ATRIUM_SANITIZE)
        return()
    endif()
    set(folder ${PROJECT_SOURCE_DIR}/deploy/packages)
    set(scripts ${folder}/make_manual.py ${folder}/help_text.py ${folder}/roff.py ${folder}/bash.py)
    set(page ${CMAKE_BINARY_DIR}/manuals/${command}.1)
    set(completion ${CMAKE_BINARY_DIR}/manuals/${command}.bash)
    set(outputs --page ${page})
    set(files ${page})
    if(NOT program STREQUAL atrium) # its completion is a file of its own
        list(APPEND outputs --completion ${completion})
        list(APPEND files ${completion})
        install(FILES ${completion} DESTINATION share/bash-completion/completions RENAME ${command} COMPONENT ${package})
    endif()
    add_custom_command(OUTPUT ${files}
        COMMAND Python3::Interpreter ${folder}/make_manual.py --program ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/${command} --command ${command}
            ${outputs}
        DEPENDS ${program} ${scripts} ${link} $<$<STREQUAL:${program},atrium>:atrium_commands>)
    set_property(GLOBAL APPEND PROPERTY atrium_manuals ${files})
    install(FILES ${page} DESTINATION share/man/man1 COMPONENT ${package})
endfunction()

find_package(Python3 REQUIRED COMPONENTS Interpreter)

# One line for each program; tools/atrium/commands.cpp has what `atrium help` says of it.
atrium_command(site site_node atrium-site atrium-site@.service)
atrium_command(camera camera_node atrium-site atrium-camera@.service)
atrium_command(world world_server atrium-world atrium-world.service)
atrium_command(viewer viewer atrium-viewer)
atrium_command(demo demo atrium-tools)
atrium_command(monitor monitor atrium-tools)
atrium_command(calibrate calibrate atrium-tools)
atrium_command(cameras simulated_cameras atrium-tools)
atrium_command(hull visual_hull atrium-tools)
atrium_command(doctor doctor atrium-tools)
if(TARGET graphics_probe) # the doctor asks it whether EGL draws
    install(TARGETS graphics_probe RUNTIME DESTINATION ${atrium_bin} COMPONENT atrium-tools)
endif()
atrium_command(keys keys atrium-tools)
atrium_command(tunnel tunnel atrium-tools)
atrium_command(plan plan atrium-tools)
atrium_command(record record atrium-tools)
atrium_command(play play atrium-tools)
atrium_command(export export atrium-tools)
foreach(name up down status logs)
    atrium_command(${name} site_control atrium-tools)
endforeach()

get_property(atrium_links GLOBAL PROPERTY atrium_links)
add_custom_target(atrium_commands ALL DEPENDS ${atrium_links})
add_dependencies(programs atrium_commands)

# programs find it in the folder lib/atrium above their own
install(TARGETS atrium_security LIBRARY DESTINATION lib/atrium COMPONENT atrium-common)
install(TARGETS atrium RUNTIME DESTINATION ${atrium_bin} COMPONENT atrium-common)
_atrium_install_link(../lib/atrium/bin/atrium bin/atrium atrium-common)
_atrium_manual(atrium atrium atrium-common "")
get_property(atrium_manuals GLOBAL PROPERTY atrium_manuals)
add_custom_target(manuals ALL DEPENDS ${atrium_manuals})

# The demo and the viewer find what they need in `deploy` beside their folder.
_atrium_install_link(../../share/atrium lib/atrium/deploy atrium-common)
function(_atrium_install_deploy package)
    foreach(path ${ARGN})
        get_filename_component(folder ${path} DIRECTORY)
        if(IS_DIRECTORY ${PROJECT_SOURCE_DIR}/deploy/${path})
            install(DIRECTORY deploy/${path} DESTINATION ${atrium_share}/${folder} COMPONENT ${package} FILES_MATCHING REGEX "\\.(toml|json|obj|png)$")
        else()
            install(FILES deploy/${path} DESTINATION ${atrium_share}/${folder} COMPONENT ${package})
        endif()
    endforeach()
endfunction()
file(GLOB atrium_worlds RELATIVE ${PROJECT_SOURCE_DIR}/deploy CONFIGURE_DEPENDS deploy/worlds/*.toml)
_atrium_install_deploy(atrium-common rigs worlds/models) # models: world servers and viewers read them
_atrium_install_deploy(atrium-site sites)
install(FILES tools/segmentation_worker/atrium_segmentation.py tools/segmentation_worker/opencv_worker.py
    DESTINATION ${atrium_share}/segmentation_worker COMPONENT atrium-site)
_atrium_install_deploy(atrium-world ${atrium_worlds})
_atrium_install_deploy(atrium-viewer viewer.toml viewer_remote.toml walls)
_atrium_install_deploy(atrium-tools costs.toml demos views)

install(FILES deploy/packages/atrium.bash DESTINATION share/bash-completion/completions RENAME atrium COMPONENT atrium-common)
install(FILES deploy/packages/90-atrium.conf DESTINATION lib/sysctl.d COMPONENT atrium-common)
install(FILES deploy/packages/60-atrium-cameras.rules DESTINATION ${ATRIUM_HOST_LIB}/udev/rules.d COMPONENT atrium-site)
install(FILES deploy/packages/atrium.desktop DESTINATION share/applications COMPONENT atrium-viewer)
install(FILES deploy/packages/atrium.svg DESTINATION share/icons/hicolor/scalable/apps COMPONENT atrium-viewer)
install(FILES deploy/packages/atrium.metainfo.xml DESTINATION share/metainfo RENAME local.atrium.viewer.metainfo.xml COMPONENT atrium-viewer)
install(FILES deploy/units/atrium.slice DESTINATION ${ATRIUM_HOST_LIB}/systemd/system COMPONENT atrium-common)
